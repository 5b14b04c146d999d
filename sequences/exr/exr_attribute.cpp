// Attributes of a header as values of ours.
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include "frame/check.h"
#include "frame/float_traps.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

template <typename Attribute>
const Attribute* as(const Imf::Attribute& attribute) {
  return dynamic_cast<const Attribute*>(&attribute);
}

template <typename Matrix>
ExrMatrix matrix_of(const Matrix& from) {
  ExrMatrix matrix;
  for (std::size_t i = 0; i < 16; ++i) {
    matrix[i] = static_cast<float>(from[static_cast<int>(i / 4)][i % 4]);
  }
  return matrix;
}

std::array<float, 2> pair_of(const Imath::V2f& v) { return {v.x, v.y}; }

std::optional<ExrValue> value_of(const Imf::Attribute& attribute) {
  if (const auto* a = as<Imf::IntAttribute>(attribute)) return a->value();
  if (const auto* a = as<Imf::FloatAttribute>(attribute)) return a->value();
  if (const auto* a = as<Imf::DoubleAttribute>(attribute)) return a->value();
  if (const auto* a = as<Imf::StringAttribute>(attribute)) return a->value();
  if (const auto* a = as<Imf::StringVectorAttribute>(attribute)) return a->value();
  if (const auto* a = as<Imf::M44fAttribute>(attribute)) return matrix_of(a->value());
  if (const auto* a = as<Imf::M44dAttribute>(attribute)) return matrix_of(a->value());
  if (const auto* a = as<Imf::V2fAttribute>(attribute)) return pair_of(a->value());
  if (const auto* a = as<Imf::V3fAttribute>(attribute)) {
    return std::array<float, 3>{a->value().x, a->value().y, a->value().z};
  }
  if (const auto* a = as<Imf::ChromaticitiesAttribute>(attribute)) {
    const Imf::Chromaticities& c = a->value();
    return ExrChromaticities{pair_of(c.red), pair_of(c.green), pair_of(c.blue), pair_of(c.white)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<ExrValue> ExrFile::attribute(const std::string& name, int part) const {
  EL_CHECK(part >= 0 && part < state_->file->parts(), "part {} of {}", part, state_->file->parts());
  const FloatTrapsOff doubles_may_be_beyond_float;
  const Imf::Header& header = state_->file->header(part);
  const auto found = header.find(name);
  if (found == header.end()) return std::nullopt;
  return value_of(found.attribute());
}

std::vector<std::string> ExrFile::attribute_names(int part) const {
  EL_CHECK(part >= 0 && part < state_->file->parts(), "part {} of {}", part, state_->file->parts());
  std::vector<std::string> names;
  for (const ExrRawAttribute& a : state_->raw.parts[static_cast<std::size_t>(part)]) {
    names.push_back(a.name);
  }
  return names;
}

}  // namespace eigenlight
