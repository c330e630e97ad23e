#include "worker/sandbox.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <sstream>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/descriptor.h"

namespace surfcast::worker {
namespace {

// glibc has no functions for Landlock.
Descriptor make_ruleset(const landlock_ruleset_attr& attributes) {
  return Descriptor(static_cast<int>(::syscall(SYS_landlock_create_ruleset, &attributes, sizeof(attributes), 0)));
}
bool add_path_rule(int ruleset, const landlock_path_beneath_attr& rule) {
  return ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}
bool restrict_self(int ruleset) {
  return ::syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
}

/// EPERM is how containers deny calls that they do not know.
tl::unexpected<Error> sandbox_error(const std::string& what, int code) {
  const bool missing = code == ENOSYS || code == EOPNOTSUPP || code == EINVAL || code == EPERM;
  return fail(missing ? ErrorKind::kUnsupported : ErrorKind::kIo, what + ": " + std::strerror(code));
}

constexpr uint64_t kReadFiles = LANDLOCK_ACCESS_FS_READ_FILE;
constexpr uint64_t kReadFolders = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr uint64_t kUseDevices = kReadFolders | LANDLOCK_ACCESS_FS_WRITE_FILE;
constexpr uint64_t kChangeFiles = kUseDevices | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                  LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR;
/// All that the first version of Landlock can forbid.
constexpr uint64_t kEverything = kUseDevices | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                 LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                 LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                 LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                 LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

/// Paths that do not exist are left out.
Status allow(int ruleset, const std::string& path, uint64_t folder_rights) {
  const Descriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  if (!place) return {};
  struct stat information {};
  const bool folder = ::fstat(place.get(), &information) == 0 && S_ISDIR(information.st_mode);
  const landlock_path_beneath_attr rule{folder ? folder_rights : kReadFiles, place.get()};
  if (!add_path_rule(ruleset, rule)) return sandbox_error("cannot allow " + path, errno);
  return {};
}

/// Calls that a worker has no use for. Those with paths are restrict_files' matter, if they can be.
constexpr std::array kForbidden{SCMP_SYS(socket),
                                SCMP_SYS(connect),
                                SCMP_SYS(bind),
                                SCMP_SYS(listen),
                                SCMP_SYS(accept),
                                SCMP_SYS(accept4),
                                SCMP_SYS(execve),
                                SCMP_SYS(execveat),
                                SCMP_SYS(fork),
                                SCMP_SYS(vfork),
                                SCMP_SYS(kill),
                                SCMP_SYS(tkill),
                                SCMP_SYS(rt_sigqueueinfo),
                                SCMP_SYS(rt_tgsigqueueinfo),
                                SCMP_SYS(pidfd_open),
                                SCMP_SYS(pidfd_getfd),
                                SCMP_SYS(pidfd_send_signal),
                                SCMP_SYS(ptrace),
                                SCMP_SYS(process_vm_readv),
                                SCMP_SYS(process_vm_writev),
                                SCMP_SYS(process_madvise),
                                SCMP_SYS(kcmp),
                                SCMP_SYS(truncate),
                                SCMP_SYS(chmod),
                                SCMP_SYS(fchmodat),
                                SCMP_SYS(chown),
                                SCMP_SYS(lchown),
                                SCMP_SYS(fchownat),
                                SCMP_SYS(utimensat),
                                SCMP_SYS(setxattr),
                                SCMP_SYS(lsetxattr),
                                SCMP_SYS(removexattr),
                                SCMP_SYS(lremovexattr),
                                SCMP_SYS(link),
                                SCMP_SYS(linkat),
                                SCMP_SYS(mount),
                                SCMP_SYS(umount2),
                                SCMP_SYS(move_mount),
                                SCMP_SYS(open_tree),
                                SCMP_SYS(fsopen),
                                SCMP_SYS(fsmount),
                                SCMP_SYS(pivot_root),
                                SCMP_SYS(chroot),
                                SCMP_SYS(unshare),
                                SCMP_SYS(setns),
                                SCMP_SYS(bpf),
                                SCMP_SYS(perf_event_open),
                                SCMP_SYS(userfaultfd),
                                SCMP_SYS(keyctl),
                                SCMP_SYS(add_key),
                                SCMP_SYS(request_key),
                                SCMP_SYS(io_uring_setup),
                                SCMP_SYS(io_uring_enter),
                                SCMP_SYS(io_uring_register),
                                SCMP_SYS(init_module),
                                SCMP_SYS(finit_module),
                                SCMP_SYS(delete_module),
                                SCMP_SYS(kexec_load),
                                SCMP_SYS(kexec_file_load),
                                SCMP_SYS(reboot),
                                SCMP_SYS(open_by_handle_at),
                                SCMP_SYS(name_to_handle_at),
                                SCMP_SYS(quotactl),
                                SCMP_SYS(swapon),
                                SCMP_SYS(swapoff),
                                SCMP_SYS(syslog),
                                SCMP_SYS(clock_settime),
                                SCMP_SYS(settimeofday),
                                SCMP_SYS(personality)};

/// 0, or a negative code as libseccomp returns it.
int add_rules(scmp_filter_ctx filter) {
  for (const int call : kForbidden) {
    if (const int code = ::seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), call, 0); code != 0) return code;
  }
  // Threads, but no processes. The flags of clone3 are in memory, which a filter cannot read; without it glibc falls
  // back to clone.
  const scmp_arg_cmp no_thread = {0, SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0};
  if (const int code = ::seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), 1, no_thread)) return code;
  if (const int code = ::seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0)) return code;
  const scmp_arg_cmp other_process = {0, SCMP_CMP_NE, static_cast<scmp_datum_t>(::getpid()), 0};
  return ::seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(tgkill), 1, other_process);
}

}  // namespace

std::vector<std::string> driver_paths() {
  std::vector<std::string> paths{"/usr",        "/lib",           "/lib64",   "/etc/ld.so.cache",
                                 "/etc/drirc",  "/etc/glvnd",     "/etc/egl", "/etc/vulkan",
                                 "/etc/nvidia", "/etc/localtime", "/proc",    "/sys"};
  for (const char* variable : {"LD_LIBRARY_PATH", "LIBGL_DRIVERS_PATH", "GBM_BACKENDS_PATH", "VK_ICD_FILENAMES",
                               "VK_DRIVER_FILES", "__EGL_VENDOR_LIBRARY_DIRS", "__EGL_VENDOR_LIBRARY_FILENAMES"}) {
    const char* const value = std::getenv(variable);
    std::istringstream parts(value != nullptr ? value : "");
    for (std::string path; std::getline(parts, path, ':');) {
      if (path.starts_with('/')) paths.push_back(path);
    }
  }
  return paths;
}

Status restrict_files(const OpenFiles& files) {
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs = kEverything;
  const Descriptor ruleset = make_ruleset(attributes);
  if (!ruleset) return sandbox_error("the kernel has no Landlock", errno);
  for (const std::string& path : files.readable) {
    if (Status allowed = allow(ruleset.get(), path, kReadFolders); !allowed) return allowed;
  }
  for (const std::string& path : files.writable) {
    if (Status allowed = allow(ruleset.get(), path, kChangeFiles); !allowed) return allowed;
  }
  if (files.devices) {
    if (Status allowed = allow(ruleset.get(), "/dev", kUseDevices); !allowed) return allowed;
  }
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return sandbox_error("cannot give up privileges", errno);
  if (!restrict_self(ruleset.get())) return sandbox_error("cannot restrict files", errno);
  return {};
}

Status restrict_calls() {
  const std::unique_ptr<void, decltype(&::seccomp_release)> filter(::seccomp_init(SCMP_ACT_ALLOW), &::seccomp_release);
  if (!filter) return sandbox_error("cannot make a filter of system calls", ENOMEM);
  int code = ::seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1);
  if (code == 0) code = add_rules(filter.get());
  if (code == 0) code = ::seccomp_load(filter.get());
  if (code != 0) return sandbox_error("cannot restrict system calls", -code);
  return {};
}

}  // namespace surfcast::worker
