# SPDX-License-Identifier: AGPL-3.0-or-later
"""Plans: steps as pure data, and what their evaluation made."""
from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _kernel
from .names import Name
from .operations import Operations

PathLike = str | os.PathLike[str]


def region(view: str, *polygons_mm: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Polygons drawn in a view, in its millimetres, for Plan.mask()."""
    return {"view": view, "polygons_mm": [_plain(polygon) for polygon in polygons_mm]}


class Plan(Operations):
    """An operation as pure data: a method for each operation of the table adds a step.

    Relative paths are relative to `folder`, which is the present one unless the plan was read from a file.
    """

    def __init__(self, scans: Mapping[str, PathLike | Mapping[str, Any]] | None = None, *,
                 voxel_mm: float | None = None, name: str = "plan", folder: PathLike = ".") -> None:
        self.folder = Path(folder)
        self.document: dict[str, Any] = {"octotomy_plan": 1, "name": name}
        if scans:
            self.document["scans"] = {
                key: dict(scan) if isinstance(scan, Mapping) else {"path": os.fspath(scan)}
                for key, scan in scans.items()
            }
        if voxel_mm is not None:
            self.document["universe"] = {"voxel_mm": voxel_mm}
        self.document["steps"] = []

    @classmethod
    def read(cls, path: PathLike) -> Plan:
        """The plan of a .plan.json file."""
        plan = cls(folder=Path(path).parent)
        plan.document = json.loads(Path(path).read_text(encoding="utf-8"))
        return plan

    def add(self, do: str, id: str, **fields: Any) -> Name:
        """Adds a step of any operation; fields that are None are left out."""
        step: dict[str, Any] = {"id": str(id), "do": do}
        step.update((key, _plain(value)) for key, value in fields.items() if value is not None)
        self.document["steps"].append(step)
        return Name(id)

    def __str__(self) -> str:
        for where in _places_not_finite(self.document):
            raise _kernel.InputError(f"{where}: must be a finite number")
        return json.dumps(self.document, indent=2, ensure_ascii=False, allow_nan=False)

    def write(self, path: PathLike) -> None:
        """Writes the plan, beside and renamed into place, so that an older file is whole until then."""
        target = Path(path)
        part = target.with_name(f".{target.name}-{os.getpid()}")
        try:
            part.write_text(str(self) + "\n", encoding="utf-8")
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)

    def run(self, *, certify: bool = True, progress: Callable[[str, float], None] | None = None) -> Result:
        """Evaluates the plan in both kernels. Raises InputError where a step is wrong, naming it.

        `progress` is called with what is being done and the fraction that is done.
        """
        return Result(_kernel.evaluate(str(self), self.folder, certify, progress))


class Made:
    """An object of a plan in both kernels."""

    def __init__(self, evaluation: _kernel.Evaluation, id: str) -> None:
        self._evaluation, self.id = evaluation, id
        #: The voxel kernel's object.
        self.octree: _kernel.Octree = evaluation.octree(id)
        #: The mesh kernel's object within the universe; None where it has no answer.
        self.solid: _kernel.Solid | None = evaluation.solid(id)

    @property
    def record(self) -> dict[str, Any]:
        """Definition, measures and findings, as result.json has them."""
        return self._evaluation.record(self.id)

    @property
    def certificate(self) -> dict[str, Any] | None:
        """Both answers, their difference, the tolerance and the verdict; None for masks and without `certify`."""
        return self._evaluation.certificate(self.id)


class Result(Mapping[str, Made]):
    """The results of a plan's steps: objects by name, measurements and files."""

    def __init__(self, evaluation: _kernel.Evaluation) -> None:
        self._evaluation = evaluation
        self._names: list[str] = evaluation.objects

    def __getitem__(self, id: str) -> Made:
        if id not in self._names:
            raise KeyError(id)
        return Made(self._evaluation, id)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def universe(self) -> _kernel.Universe:
        """Of its octrees."""
        return self._evaluation.universe

    @property
    def measurements(self) -> list[dict[str, Any]]:
        """The answers of the plan's measurements, in the order of their steps."""
        return self._evaluation.measurements

    @property
    def timings_ms(self) -> dict[str, float]:
        """Milliseconds by stage."""
        return self._evaluation.timings_ms

    def write(self, folder: PathLike) -> dict[str, Any]:
        """Writes result.json, report.html, pictures and exports as `octotomy run` does; returns result.json."""
        return self._evaluation.write(Path(folder))


def _places_not_finite(value: Any, where: str = "") -> Iterator[str]:
    """Where JSON cannot have a number: "step 'cut', rotate, degrees"."""
    if isinstance(value, float) and not math.isfinite(value):
        yield where
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from _places_not_finite(each, f"{where}, {key}" if where else str(key))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for each in value:
            is_step = where == "steps" and isinstance(each, Mapping) and "id" in each
            yield from _places_not_finite(each, f"step '{each['id']}'" if is_step else where)


def _plain(value: Any) -> Any:
    """Arrays, tuples, names and paths as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, str):
        return str(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, Sequence):
        return [_plain(each) for each in value]
    return value
