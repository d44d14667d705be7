// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/confine.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace octotomy::voxel {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;
#endif

/// Calls that are refused.
constexpr std::array refused{
    // Calls that start programs or act on other processes and their memory.
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kill,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    // Calls for the network and for sockets of other programs.
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    // File systems and names.
    SYS_mount,
    SYS_umount2,
    SYS_chroot,
    SYS_pivot_root,
    SYS_unshare,
    SYS_setns,
    SYS_mknodat,
    SYS_open_by_handle_at,
    // Calls that change rights, kernel interfaces or the machine.
    SYS_setuid,
    SYS_setgid,
    SYS_setresuid,
    SYS_setresgid,
    SYS_capset,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_init_module,
    SYS_finit_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_settimeofday,
    SYS_clock_settime,
#ifdef SYS_fork
    SYS_fork,
    SYS_vfork,
#endif
};

constexpr sock_filter step(std::uint16_t code, std::uint32_t value, std::uint8_t if_true = 0,
                           std::uint8_t if_false = 0) {
  return {code, if_true, if_false, value};
}

/// A filter of system calls in classic BPF. Refuses every call of another architecture, and the calls
/// listed above. Also refuses clone without CLONE_THREAD, which would start a process. clone3 fails as if it
/// did not exist, so that the C library uses clone instead.
bool filter_calls() {
  constexpr std::uint32_t refuse = SECCOMP_RET_ERRNO | EPERM;
  constexpr std::uint32_t clone_thread = 0x00010000;
  std::array<sock_filter, 2 * refused.size() + 11> filter{};
  std::size_t count = 0;
  const auto add = [&](const sock_filter& next) { filter[count++] = next; };
  add(step(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)));
  add(step(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0));
  add(step(BPF_RET | BPF_K, refuse));
  add(step(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
  for (const long call : refused) {
    add(step(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
    add(step(BPF_RET | BPF_K, refuse));
  }
  add(step(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1));
  add(step(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS));
  add(step(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3));
  add(step(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args)));
  add(step(BPF_JMP | BPF_JSET | BPF_K, clone_thread, 1, 0));
  add(step(BPF_RET | BPF_K, refuse));
  add(step(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog program{static_cast<unsigned short>(count), filter.data()};
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// Forbids changes of files except below one folder. Empty folders can still be removed anywhere, so that the
/// process can remove the folder itself.
bool keep_files(const std::filesystem::path& writable) {
  landlock_ruleset_attr rules{};
  rules.handled_access_fs =
      LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
      LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
      LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;
  const auto ruleset = static_cast<int>(syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0));
  if (ruleset < 0) return false;
  landlock_path_beneath_attr beneath{};
  beneath.allowed_access = rules.handled_access_fs;
  beneath.parent_fd = open(writable.c_str(), O_PATH | O_CLOEXEC);
  const bool is_kept =
      beneath.parent_fd >= 0 &&
      syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0) == 0 &&
      syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
  if (beneath.parent_fd >= 0) close(beneath.parent_fd);
  close(ruleset);
  return is_kept;
}

}  // namespace

bool confine(const std::filesystem::path& writable) noexcept {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  const bool is_kept = keep_files(writable);
  return architecture != 0 && filter_calls() && is_kept;
}

}  // namespace octotomy::voxel
