// K x K algebra in double, on Eigen, without heap.
#pragma once

#include <Eigen/Dense>

#include "reproject/basis_field.h"

namespace eigenlight {

/// Up to kMaxBases in each direction; storage is inside the object.
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxBases, kMaxBases>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxBases, 1>;

}  // namespace eigenlight
