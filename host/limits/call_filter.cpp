#include "host/limits/call_filter.h"

#include <asm/sockios.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <initializer_list>

namespace chladni {
namespace {

#if defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#endif
constexpr std::uint32_t kFirstOfX32 = 0x40000000;  // calls by 32-bit addresses on x86-64
constexpr std::uint32_t kAnyProcess = 0x70726F63;  // replaced by the worker's own number

constexpr std::uint32_t kEnd = SECCOMP_RET_KILL_PROCESS;
constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW;
constexpr std::uint32_t refusal(int error) {
  return SECCOMP_RET_ERRNO | (static_cast<std::uint32_t>(error) & SECCOMP_RET_DATA);
}

using Calls = std::initializer_list<int>;
using Values = std::initializer_list<std::uint32_t>;

// No reading of a file needs these, and no library tries them in passing.
constexpr Calls kFatal = {
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kcmp,
    SYS_tkill,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_pidfd_send_signal,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_process_madvise,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_unshare,
    SYS_setns,
    SYS_open_tree,
    SYS_move_mount,
    SYS_fsopen,
    SYS_fsmount,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_acct,
    SYS_quotactl,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_adjtimex,
    SYS_clock_adjtime,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_open_by_handle_at,
    SYS_fanotify_init,
#if defined(__x86_64__)
    SYS_fork,
    SYS_vfork,
    SYS_iopl,
    SYS_ioperm,
    SYS_modify_ldt,
#endif
};

// A library may try these and go on without.
constexpr Calls kRefused = {
    SYS_socketpair,    SYS_setpgid,        SYS_setsid,        SYS_setrlimit,   SYS_unlinkat,
    SYS_renameat2,     SYS_linkat,         SYS_symlinkat,     SYS_mkdirat,     SYS_mknodat,
    SYS_fchmodat,      SYS_fchmod,         SYS_fchownat,      SYS_fchown,      SYS_truncate,
    SYS_ftruncate,     SYS_setxattr,       SYS_lsetxattr,     SYS_fsetxattr,   SYS_removexattr,
    SYS_lremovexattr,  SYS_fremovexattr,   SYS_utimensat,     SYS_shmget,      SYS_shmat,
    SYS_msgget,        SYS_semget,         SYS_mq_open,       SYS_setpriority, SYS_ioprio_set,
    SYS_sched_setattr, SYS_sched_setparam, SYS_migrate_pages, SYS_move_pages,
#if defined(__x86_64__)
    SYS_creat,         SYS_unlink,         SYS_rename,        SYS_renameat,    SYS_link,
    SYS_symlink,       SYS_mkdir,          SYS_rmdir,         SYS_mknod,       SYS_chmod,
    SYS_chown,         SYS_lchown,         SYS_utime,         SYS_utimes,      SYS_futimesat,
#endif
};

/// Writes the program.
class CallFilter {
 public:
  CallFilter() {
    load(offsetof(seccomp_data, arch));
    put(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    end(kEnd);
    load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
    put(BPF_JMP | BPF_JGE | BPF_K, kFirstOfX32, 0, 1);
    end(kEnd);
#endif
  }

  void each(const Calls& calls, std::uint32_t action) {
    for (const int call : calls) {
      skip_unless(call, 1);
      end(action);
    }
  }

  /// The action if the low half of the argument is one of the values, else the other one. It is
  /// the whole of an argument that the kernel takes as an int, never that of a pointer.
  void if_one_of(int call, std::size_t argument, Values values, std::uint32_t action,
                 std::uint32_t otherwise) {
    skip_unless(call, static_cast<std::uint8_t>(2 * values.size() + 2));
    load(low_half(argument));
    for (const auto value : values) end_if(BPF_JEQ, value, action);
    end(otherwise);
  }
  /// The action if the low half of the argument has one of the bits.
  void if_bits(int call, std::size_t argument, std::uint32_t bits, std::uint32_t action,
               std::uint32_t otherwise) {
    skip_unless(call, 4);
    load(low_half(argument));
    end_if(BPF_JSET, bits, action);
    end(otherwise);
  }
  /// Allows prlimit64 to tell the worker its own limits: no other process, no new limits.
  void own_limits_alone(std::uint32_t otherwise) {
    skip_unless(SYS_prlimit64, 11);
    load(low_half(0));
    put(BPF_JMP | BPF_JEQ | BPF_K, 0, 2, 0);
    put(BPF_JMP | BPF_JEQ | BPF_K, kAnyProcess, 1, 0);
    end(otherwise);
    for (const std::size_t half : {low_half(2), low_half(2) + 4}) {
      load(half);
      put(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0);
      end(otherwise);
    }
    end(kAllow);
  }

  std::vector<sock_filter> ended(std::uint32_t action) {
    end(action);
    return program_;
  }

 private:
  // Little-endian.
  static std::size_t low_half(std::size_t argument) {
    return offsetof(seccomp_data, args) + 8 * argument;
  }
  void end_if(std::uint16_t how, std::uint32_t value, std::uint32_t action) {
    put(static_cast<std::uint16_t>(BPF_JMP | how | BPF_K), value, 0, 1);
    end(action);
  }

  void skip_unless(int call, std::uint8_t count) {
    put(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, count);
  }
  void load(std::size_t offset) {
    put(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset), 0, 0);
  }
  void end(std::uint32_t action) { put(BPF_RET | BPF_K, action, 0, 0); }
  void put(std::uint16_t code, std::uint32_t value, std::uint8_t if_true, std::uint8_t if_false) {
    program_.push_back({code, if_true, if_false, value});
  }

  std::vector<sock_filter> program_;
};

}  // namespace

std::vector<sock_filter> call_filter() {
  constexpr std::uint32_t changes = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  CallFilter filter;
  filter.each(kFatal, kEnd);
  filter.each(kRefused, refusal(EACCES));
  filter.each({SYS_clone3, SYS_openat2}, refusal(ENOSYS));  // their flags cannot be seen
  filter.if_bits(SYS_clone, 0, CLONE_THREAD, kAllow, kEnd);
  filter.if_bits(SYS_openat, 2, changes, refusal(EACCES), kAllow);
#if defined(__x86_64__)
  filter.if_bits(SYS_open, 1, changes, refusal(EACCES), kAllow);
#endif
  filter.if_one_of(SYS_socket, 0, {AF_UNIX}, refusal(EACCES), kEnd);
  filter.if_one_of(SYS_kill, 0, {kAnyProcess}, kAllow, kEnd);
  filter.if_one_of(SYS_tgkill, 0, {kAnyProcess}, kAllow, kEnd);
  // The owner of a pipe gets signals when bytes move: any signal, and any process may be the owner.
  filter.if_one_of(SYS_fcntl, 1, {F_SETOWN, F_SETOWN_EX, F_SETSIG, F_SETLEASE}, kEnd, kAllow);
  filter.if_one_of(SYS_ioctl, 1, {FIOSETOWN, SIOCSPGRP}, kEnd, kAllow);
  for (const int call : {SYS_sched_setaffinity, SYS_sched_setscheduler}) {
    filter.if_one_of(call, 0, {0, kAnyProcess}, kAllow, refusal(EPERM));
  }
  filter.own_limits_alone(refusal(EPERM));  // glibc's getrlimit
  return filter.ended(kAllow);
}

void set_own_process(std::vector<sock_filter>& filter, std::uint32_t process) noexcept {
  for (auto& instruction : filter) {
    if (instruction.code == (BPF_JMP | BPF_JEQ | BPF_K) && instruction.k == kAnyProcess) {
      instruction.k = process;
    }
  }
}

}  // namespace chladni
