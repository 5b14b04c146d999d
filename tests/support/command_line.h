// Runs a command line of the program within the test.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "frame/tiles.h"
#include "sequences/cli/cli.h"

namespace eigenlight {

/// What a command line left: exit status and both streams.
struct Outcome {
  int status = 0;
  std::string out, err;
};

/// `words` without the name of the program. Takes back the number of threads that it chose.
inline Outcome call(std::vector<std::string> words) {
  words.insert(words.begin(), "eigenlight");
  std::vector<const char*> args;
  for (const std::string& word : words) args.push_back(word.c_str());
  std::ostringstream out, err;
  const int status = run_command_line(args, {out, err, false, ""});
  set_thread_count(0);
  return {status, out.str(), err.str()};
}

}  // namespace eigenlight
