#include "sequences/layers/layer_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "frame/named.h"

namespace eigenlight {
namespace {

struct NamedRole {
  Role role;
  std::string_view name;
};
constexpr std::array<NamedRole, 13> kRoles{{{Role::kBeauty, "beauty"},
                                            {Role::kLight, "light"},
                                            {Role::kEmission, "emission"},
                                            {Role::kColor, "color"},
                                            {Role::kAlbedo, "albedo"},
                                            {Role::kNormal, "normal"},
                                            {Role::kDepth, "depth"},
                                            {Role::kPosition, "position"},
                                            {Role::kMotion, "motion"},
                                            {Role::kId, "id"},
                                            {Role::kVariance, "variance"},
                                            {Role::kNoisy, "noisy"},
                                            {Role::kOther, "other"}}};

// Cycles divides by the color; all others write light as it is seen. `true` behind the sum: direct
// light.
constexpr std::array kLights{
    // Cycles
    LightName{"diffdir", "diffuse direct", "diffcol", true, "", true},
    LightName{"diffind", "diffuse indirect", "diffcol", true, ""},
    LightName{"glossdir", "glossy direct", "glosscol", true, "", true},
    LightName{"glossind", "glossy indirect", "glosscol", true, ""},
    LightName{"transdir", "transmission direct", "transcol", true, "", true},
    LightName{"transind", "transmission indirect", "transcol", true, ""},
    LightName{"subsurfacedir", "subsurface direct", "subsurfacecol", true, "", true},
    LightName{"subsurfaceind", "subsurface indirect", "subsurfacecol", true, ""},
    LightName{"volumedir", "volume direct", "", true, "", true},
    LightName{"volumeind", "volume indirect", "", true, ""},
    // Arnold
    LightName{"diffusedirect", "diffuse direct", "diffusealbedo", false, "diffuse", true},
    LightName{"diffuseindirect", "diffuse indirect", "diffusealbedo", false, "diffuse"},
    LightName{"speculardirect", "specular direct", "specularalbedo", false, "specular", true},
    LightName{"specularindirect", "specular indirect", "specularalbedo", false, "specular"},
    LightName{"coatdirect", "coat direct", "coatalbedo", false, "coat", true},
    LightName{"coatindirect", "coat indirect", "coatalbedo", false, "coat"},
    LightName{"sheendirect", "sheen direct", "sheenalbedo", false, "sheen", true},
    LightName{"sheenindirect", "sheen indirect", "sheenalbedo", false, "sheen"},
    LightName{"transmissiondirect", "transmission direct", "transmissionalbedo", false,
              "transmission", true},
    LightName{"transmissionindirect", "transmission indirect", "transmissionalbedo", false,
              "transmission"},
    LightName{"sssdirect", "subsurface direct", "sssalbedo", false, "sss", true},
    LightName{"sssindirect", "subsurface indirect", "sssalbedo", false, "sss"},
    LightName{"volumedirect", "volume direct", "", false, "volume", true},
    LightName{"volumeindirect", "volume indirect", "", false, "volume"},
    LightName{"diffuse", "diffuse", "diffusealbedo", false, ""},
    LightName{"specular", "specular", "specularalbedo", false, ""},
    LightName{"coat", "coat", "coatalbedo", false, ""},
    LightName{"sheen", "sheen", "sheenalbedo", false, ""},
    LightName{"transmission", "transmission", "transmissionalbedo", false, ""},
    LightName{"sss", "subsurface", "sssalbedo", false, ""},
    LightName{"volume", "volume", "", false, ""},
    // RenderMan
    LightName{"directdiffuse", "diffuse direct", "albedo", false, "diffuse", true},
    LightName{"indirectdiffuse", "diffuse indirect", "albedo", false, "diffuse"},
    LightName{"directspecular", "specular direct", "", false, "specular", true},
    LightName{"indirectspecular", "specular indirect", "", false, "specular"},
    LightName{"subsurface", "subsurface", "albedo", false, ""},
    LightName{"transmissive", "transmission", "", false, ""},
    // V-Ray
    LightName{"lighting", "diffuse direct", "diffuse", false, "", true},
    LightName{"gi", "diffuse indirect", "diffuse", false, ""},
    LightName{"globalillumination", "diffuse indirect", "diffuse", false, ""},
    LightName{"reflect", "reflection", "", false, ""},
    LightName{"refract", "refraction", "", false, ""},
    LightName{"reflection", "reflection", "", false, ""},
    LightName{"refraction", "refraction", "", false, ""},
    // Redshift
    LightName{"diffuselighting", "diffuse direct", "diffusefilter", false, "", true},
    LightName{"specularlighting", "specular direct", "", false, "", true},
    LightName{"reflections", "reflection", "", false, ""},
    LightName{"refractions", "refraction", "", false, ""},
    // this project
    LightName{"direct", "diffuse direct", "albedo", false, "", true},
    LightName{"indirect", "diffuse indirect", "albedo", false, ""},
};

// Beginnings of LightName::what.
constexpr std::array<std::string_view, 6> kGlossy{"glossy",       "specular",   "coat",
                                                  "transmission", "reflection", "refraction"};

}  // namespace

std::string_view role_name(Role role) {
  return std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& r) { return r.role == role; })
      ->name;
}

std::string layer_word(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot != std::string_view::npos) name.remove_prefix(dot + 1);
  std::string word;
  for (const unsigned char c : name) {
    if (c != ' ' && c != '_' && c != '-') word += static_cast<char>(std::tolower(c));
  }
  return word;
}

bool is_glossy(std::string_view what) {
  return std::any_of(kGlossy.begin(), kGlossy.end(),
                     [&](std::string_view kind) { return what.starts_with(kind); });
}

const LightName* find_light(std::string_view word) {
  const auto found = std::find_if(kLights.begin(), kLights.end(),
                                  [&](const LightName& light) { return light.name == word; });
  return found == kLights.end() ? nullptr : &*found;
}

const std::vector<std::string_view>& words_of(Role role) {
  using Words = std::vector<std::string_view>;
  static const std::map<Role, Words> all{
      {Role::kBeauty, {"", "combined", "rgba", "rgb", "rgbamain", "beauty", "ci", "color", "y"}},
      {Role::kEmission, {"emit", "emission", "env", "background", "selfillum", "environment"}},
      {Role::kAlbedo,
       {"albedo", "diffusealbedo", "diffcol", "denoisingalbedo", "diffusefilter", "denoisealbedo",
        "basecolor"}},
      {Role::kNormal,
       {"normal", "n", "normals", "shnormal", "ns", "worldnormal", "denoisingnormal",
        "bumpnormals"}},
      {Role::kDepth, {"depth", "z", "zdepth", "zfiltered", "denoisingdepth"}},
      {Role::kPosition, {"position", "p", "worldposition", "pworld"}},
      {Role::kMotion,
       {"vector", "motionvector", "motion", "motionvectors", "backward", "motionback", "motionfore",
        "forward", "velocity"}},
      {Role::kId, {"id", "objectid", "indexob", "instanceid"}},
      {Role::kVariance, {"variance", "mse", "relativevariance", "noiselevel"}},
      {Role::kNoisy, {"noisyimage"}}};
  static const Words none;
  const auto found = all.find(role);
  return found == all.end() ? none : found->second;
}

Role parse_role(std::string_view text) { return find_named(kRoles, text, "role").role; }

}  // namespace eigenlight
