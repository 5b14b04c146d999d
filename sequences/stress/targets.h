// The instruction sets that vector kernels were built for.
#pragma once

#include <functional>
#include <string_view>

namespace eigenlight {

/// Calls body(name) with all kernels bound to each instruction set that this machine and this build
/// have, in turn. The machine's own choice is restored afterwards, after an exception too.
void for_each_instruction_set(const std::function<void(std::string_view)>& body);

}  // namespace eigenlight
