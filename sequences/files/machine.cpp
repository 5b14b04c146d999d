#include "sequences/files/machine.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

namespace eigenlight {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string instruction_set() {
#if defined(__x86_64__)
  // Highway's AVX3 needs these five.
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd")) {
    return "AVX-512";
  }
  if (__builtin_cpu_supports("avx2")) return "AVX2";
  if (__builtin_cpu_supports("sse4.2")) return "SSE4.2";
#endif
  return "no AVX-512, AVX2 or SSE4.2";
}

}  // namespace

Machine this_machine() {
  return {processor_name(), instruction_set(), "GCC " __VERSION__,
          std::thread::hardware_concurrency()};
}

double machine_memory() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(::sysconf(_SC_PAGESIZE));
}

nlohmann::ordered_json to_json(const Machine& machine) {
  return {{"processor", machine.processor},
          {"instruction_set", machine.instruction_set},
          {"cores", machine.cores},
          {"compiler", machine.compiler}};
}

std::string to_text(const Machine& machine) {
  return fmt::format("{}, {} cores, {}", machine.processor, machine.cores, machine.instruction_set);
}

std::string today() { return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))); }

}  // namespace eigenlight
