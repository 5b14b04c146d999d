// Runs a fuzz target over the files of directories, without libFuzzer: seeds, and whatever once
// made it fail, as an ordinary test. Arguments: directories.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "frame/float_traps.h"
#include "sequences/files/atomic_file.h"
#include "tests/fuzz/target.h"

int main(int argc, char** argv) {
  eigenlight::trap_float_faults();
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    // Before the run: the last line names the culprit.
    std::printf("%s\n", file.filename().c_str());
    std::fflush(stdout);
    const std::string bytes = eigenlight::read_whole_file(file);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::printf("%zu inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
