// SPDX-License-Identifier: AGPL-3.0-or-later
// Exceptions by the kinds of errors.
#include <array>
#include <string>

#include "planner/operation/table/fault.h"
#include "planner/python/arrays.h"
#include "planner/python/module.h"

namespace octotomy::planner::python {
namespace {

/// The exception classes in the order of Fault. They are never freed, because Python uses them until it ends.
std::array<PyObject*, 5> of_fault{};

PyObject* new_error(py::module_& module, const char* name, const char* says, const py::object& bases) {
  const std::string full = "octotomy." + std::string(name);
  PyObject* error = PyErr_NewExceptionWithDoc(full.c_str(), says, bases.ptr(), nullptr);
  if (error == nullptr) throw py::error_already_set();
  module.add_object(name, py::handle(error));
  return error;
}

void set_error(const std::exception& error) {
  PyErr_SetObject(of_fault.at(static_cast<std::size_t>(fault_of(error))),
                  text_of(message_of(error).c_str()).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::invalid_argument& error) {
    if (fault_of(error) != Fault::Input) return set_error(error);
    PyErr_SetObject(PyExc_ValueError, text_of(error.what()).ptr());
  } catch (const std::exception& error) {
    set_error(error);
  }
}

}  // namespace

void add_errors(py::module_& module) {
  const py::handle runtime(PyExc_RuntimeError), value(PyExc_ValueError);
  const py::object base = py::reinterpret_borrow<py::object>(
      new_error(module, "Error", "A refusal by a kernel or the planner, with place, cause and remedy.",
                py::reinterpret_borrow<py::object>(runtime)));
  of_fault = {
      new_error(module, "InputError", "Data or text from outside is wrong.", py::make_tuple(base, value)),
      new_error(module, "GeometryError", "The data are sound, but the operation has no answer on them.",
                base),
      new_error(module, "CancelledError", "The work was stopped.", base),
      new_error(module, "ResourceError", "Memory, disk or time is exhausted, or a child process failed.",
                base),
      new_error(module, "InternalError", "A mistake in the program: please report it.", base)};
  py::register_exception_translator(translate);
}

}  // namespace octotomy::planner::python
