// The methods by the names that users give them.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "temporal/denoiser.h"

namespace eigenlight {

/// A method as a user names it.
struct Method {
  std::string_view name;
  std::string_view what;   ///< one line
  std::string_view paper;  ///< authors and year, or empty
  std::unique_ptr<Denoiser> (*make)(const DenoiserOptions&);
  std::span<const Part> parts = {};
};

/// All methods, in the order they are listed. `reference` is not among them: it is a way to render.
[[nodiscard]] const std::vector<Method>& methods();

/// Throws std::invalid_argument listing the known methods if `name` is none, listing its parts if
/// it has none of a name in `without`, or naming a bad option.
[[nodiscard]] std::unique_ptr<Denoiser> make_denoiser(std::string_view name,
                                                      const DenoiserOptions& options);

}  // namespace eigenlight
