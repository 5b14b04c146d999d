#include "sequences/compare/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

// Where the child's input and output go.
class Redirection {
 public:
  Redirection() { ::posix_spawn_file_actions_init(&actions_); }
  ~Redirection() { ::posix_spawn_file_actions_destroy(&actions_); }
  Redirection(const Redirection&) = delete;
  Redirection& operator=(const Redirection&) = delete;

  void open(int descriptor, const std::string& path, int flags) {
    ::posix_spawn_file_actions_addopen(&actions_, descriptor, path.c_str(), flags, 0600);
  }
  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

double milliseconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

pid_t start(const std::string& command, const Redirection& redirection) {
  std::string shell = "/bin/sh", option = "-c", text = command;
  char* const words[] = {shell.data(), option.data(), text.data(), nullptr};
  pid_t pid = 0;
  const int error = ::posix_spawn(&pid, shell.c_str(), redirection.get(), nullptr, words, environ);
  if (error == 0) return pid;
  throw std::runtime_error(fmt::format("cannot start /bin/sh: {}", std::strerror(error)));
}

// Largest resident set so far of a process or of one of its descendants, in bytes. Not rusage's:
// its maximum counts the memory of the process that started it.
double high_water(pid_t pid) {
  double most = 0.0;
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string line; std::getline(status, line);) {
    constexpr std::string_view kName = "VmHWM:";
    if (line.starts_with(kName)) most = 1024.0 * std::strtod(line.c_str() + kName.size(), nullptr);
  }
  std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", pid));
  for (pid_t child = 0; children >> child;) most = std::max(most, high_water(child));
  return most;
}

// Waits for the end of `pid`, watching its memory.
int watch(pid_t pid, rusage& usage, double& peak_bytes) {
  constexpr timespec kPause{0, 5'000'000};
  while (true) {
    int status = 0;
    const pid_t ended = ::wait4(pid, &status, WNOHANG, &usage);
    if (ended == pid) return status;
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(fmt::format("cannot wait for a program: {}", std::strerror(errno)));
    }
    peak_bytes = std::max(peak_bytes, high_water(pid));
    ::nanosleep(&kPause, nullptr);
  }
}

std::string take(const std::filesystem::path& path) {
  std::string text = read_whole_file(path);
  std::filesystem::remove(path);
  return text;
}

}  // namespace

ChildResult run_shell(const std::string& command, const std::filesystem::path& scratch) {
  const std::filesystem::path out = scratch / "out.txt", err = scratch / "err.txt";
  Redirection redirection;
  redirection.open(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirection.open(STDOUT_FILENO, out.string(), O_WRONLY | O_CREAT | O_TRUNC);
  redirection.open(STDERR_FILENO, err.string(), O_WRONLY | O_CREAT | O_TRUNC);
  const pid_t pid = start(command, redirection);
  rusage usage = {};
  double peak_bytes = 0.0;
  const int status = watch(pid, usage, peak_bytes);
  ChildResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.cpu_ms = milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
  result.peak_mb = peak_bytes * 1e-6;
  result.out = take(out);
  result.err = take(err);
  return result;
}

}  // namespace eigenlight
