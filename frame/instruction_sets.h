// The instruction sets that vector kernels were built for.
#pragma once

#include <functional>
#include <string_view>

namespace eigenlight {

/// Binds all kernels to each instruction set that this machine and this build have, in turn, and
/// calls body(name). The machine's own choice is restored afterwards, also after an exception.
void for_each_instruction_set(const std::function<void(std::string_view)>& body);

}  // namespace eigenlight
