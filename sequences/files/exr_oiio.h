// What reading and writing EXR files through OpenImageIO share.
#pragma once

#include <string>

namespace eigenlight {

/// The name by which OpenImageIO knows an attribute.
[[nodiscard]] std::string oiio_name(const std::string& exr_name);

/// Throws std::runtime_error: the path and the reason in one line.
[[noreturn]] void fail_exr(const std::string& path, std::string reason);

/// Gives OpenImageIO and OpenEXR as many threads as we use.
void use_our_threads_for_exr();

}  // namespace eigenlight
