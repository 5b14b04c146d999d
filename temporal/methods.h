// All methods by name.
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

/// Throws std::invalid_argument: for an unknown `name` it lists the methods, for an unknown name in
/// `without` the parts of the method; for a bad option it names the option.
[[nodiscard]] std::unique_ptr<Denoiser> make_denoiser(std::string_view name,
                                                      const DenoiserOptions& options);

}  // namespace eigenlight
