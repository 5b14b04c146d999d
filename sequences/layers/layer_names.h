// What layers of other renderers are, by their names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace eigenlight {

/// What a layer is to the denoiser.
enum class Role {
  kBeauty,    ///< the picture
  kLight,     ///< a part of the picture that is noisy
  kEmission,  ///< a part of the picture without noise: emission, environment
  kColor,     ///< what a layer of light is multiplied by
  kAlbedo,
  kNormal,
  kDepth,
  kPosition,
  kMotion,
  kId,
  kVariance,  ///< a renderer's own estimate of noise
  kNoisy,     ///< the picture before the renderer's own denoiser
  kOther
};
[[nodiscard]] std::string_view role_name(Role role);

/// A layer of light by its name in some renderer's files.
struct LightName {
  std::string_view name;   ///< as layer_word() gives it
  std::string_view what;   ///< "diffuse direct"
  std::string_view color;  ///< word of the layer it is multiplied by, or of its albedo; or empty
  bool is_divided;         ///< the file has it without that color
  std::string_view sum;    ///< word of a layer that is the sum of this one and others, or empty
  bool is_direct = false;  ///< its edges, those of shadows, are in no guide
};

/// Light that moves otherwise than the surface on which it is seen: glossy, coat, transmission.
[[nodiscard]] bool is_glossy(std::string_view what);

/// The last word of a layer's name, in lower case and without blanks, `_` and `-`:
/// `ViewLayer.Denoising Albedo` gives `denoisingalbedo`.
[[nodiscard]] std::string layer_word(std::string_view name);

/// The light of that word, or null.
[[nodiscard]] const LightName* find_light(std::string_view word);

/// Words of layers of a role other than kLight and kColor, best first.
[[nodiscard]] const std::vector<std::string_view>& words_of(Role role);

/// The role of that text in `--map ROLE=LAYER`. Throws std::invalid_argument listing the roles.
[[nodiscard]] Role parse_role(std::string_view text);

}  // namespace eigenlight
