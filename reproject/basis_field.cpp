#include "reproject/basis_field.h"

namespace eigenlight {

void BasisField::assign(const BasisField& other) {
  EL_CHECK(extent_ == other.extent_, "bases of {}x{} assigned to {}x{}", other.extent_.width,
           other.extent_.height, extent_.width, extent_.height);
  clear();
  const int both = std::min(bases_, other.bases_);
  for (int y = 0; y < extent_.height; ++y) {
    for (int x = 0; x < extent_.width; x += kBlock) {
      const float* from = other.at(x, y);
      float* to = at(x, y);
      const auto copy = [&](int line, int other_line) {
        std::copy_n(from + kBlock * other_line, kBlock, to + kBlock * line);
      };
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < both; ++k) copy(line_of(c, k), other.line_of(c, k));
      }
      std::copy_n(other.ages(x, y), kBlock, ages(x, y));
    }
  }
}

void BasisField::clear_basis(int k) {
  for (int y = 0; y < extent_.height; ++y) {
    for (int x = 0; x < extent_.width; x += kBlock) {
      for (int c = 0; c < 3; ++c) std::fill_n(at(x, y) + kBlock * line_of(c, k), kBlock, 0.0f);
    }
  }
}

}  // namespace eigenlight
