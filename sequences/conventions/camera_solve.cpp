#include "sequences/conventions/camera_solve.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/check.h"
#include "sequences/conventions/background.h"
#include "sequences/conventions/sampling.h"

namespace eigenlight {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kFewest = 64;
constexpr double kSampled = 20000;
// Least over largest variance of positions: half's rounding leaves 2e-7 of a plane.
constexpr double kFlat = 1e-5;
constexpr double kWorstResidual = 2.0;  // pixels
// A shifted view axis is taken if it lowers the residual to that.
constexpr double kShiftGain = 0.7;

struct Point {
  Vector3d world;
  Vector2d pixel;
};

std::vector<Point> sample_points(const Planes<3>& position, const Plane<float>& depth) {
  const Extent extent = position[0].extent();
  const int step = grid_step(extent, kSampled);
  std::vector<Point> points;
  for (int y = step / 2; y < extent.height; y += step) {
    for (int x = step / 2; x < extent.width; x += step) {
      if (!depth.empty() && is_background(depth(x, y))) continue;
      const float p[3] = {position[0](x, y), position[1](x, y), position[2](x, y)};
      const auto usable = [](float v) { return std::isfinite(v) && std::abs(v) < kFarthestDepth; };
      if (!usable(p[0]) || !usable(p[1]) || !usable(p[2])) continue;
      if (p[0] == 0.0f && p[1] == 0.0f && p[2] == 0.0f) continue;
      points.push_back({{p[0], p[1], p[2]}, {x + 0.5, y + 0.5}});
    }
  }
  return points;
}

// World and pixels moved and scaled to about unit size.
struct Normalization {
  Vector3d mean = Vector3d::Zero();
  double size = 1.0;
  Vector2d center;
  double half_width;
};

// False if the positions lie in one plane.
bool normalize(const std::vector<Point>& points, Extent extent, Normalization& unit) {
  const double count = static_cast<double>(points.size());
  for (const Point& point : points) unit.mean += point.world / count;
  Matrix3d covariance = Matrix3d::Zero();
  for (const Point& point : points) {
    const Vector3d d = point.world - unit.mean;
    covariance += d * d.transpose() / count;
  }
  unit.size = std::sqrt(covariance.trace());
  unit.center = {0.5 * extent.width, 0.5 * extent.height};
  unit.half_width = 0.5 * extent.width;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  return unit.size > 0.0 && solver.eigenvalues()[0] > kFlat * solver.eigenvalues()[2];
}

// The smallest eigenvector of the weighted equations.
Matrix34 solve_linear(const std::vector<Point>& points, const std::vector<double>& weights,
                      const Normalization& unit) {
  Eigen::Matrix<double, 12, 12> square = Eigen::Matrix<double, 12, 12>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d d = (points[i].world - unit.mean) / unit.size;
    const Eigen::Vector4d world(d[0], d[1], d[2], 1.0);
    const Vector2d pixel = (points[i].pixel - unit.center) / unit.half_width;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 12, 1> row = Eigen::Matrix<double, 12, 1>::Zero();
      row.segment<4>(4 * axis) = world;
      row.tail<4>() = -pixel[axis] * world;
      square.noalias() += weights[i] * row * row.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(square);
  const Eigen::Matrix<double, 12, 1> p = solver.eigenvectors().col(0);
  Matrix34 projection;
  for (int row = 0; row < 3; ++row) projection.row(row) = p.segment<4>(4 * row).transpose();
  return projection;
}

// Linear, then weighted by distance in pixels in place of that of the equations, and with less
// weight for what does not fit.
Matrix34 solve_projection(const std::vector<Point>& points, const Normalization& unit) {
  std::vector<double> weights(points.size(), 1.0);
  Matrix34 projection;
  for (int round = 0; round < 5; ++round) {
    projection = solve_linear(points, weights, unit);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d d = (points[i].world - unit.mean) / unit.size;
      const Vector3d image = projection * Eigen::Vector4d(d[0], d[1], d[2], 1.0);
      const Vector2d pixel = (points[i].pixel - unit.center) / unit.half_width;
      const double w = std::max(std::abs(image[2]), 1e-9);
      const double residual =
          (image.head<2>() / image[2] - pixel).norm() * unit.half_width / kWorstResidual;
      const double fit = 1.0 + residual * residual;
      weights[i] = image[2] != 0.0 ? 1.0 / (w * w * fit * fit) : 0.0;
    }
  }
  return projection;
}

struct Pinhole {
  Matrix3d rotation = Matrix3d::Identity();  // rows right, down, forward; may be a reflection
  Vector3d eye = Vector3d::Zero();
  double focal = 1.0;
  Vector2d center = Vector2d::Zero();
};

// projection = calibration * rotation * (world - eye).
std::optional<Pinhole> decompose(const Matrix34& normalized, const std::vector<Point>& points,
                                 const Normalization& unit) {
  Matrix3d left = normalized.leftCols<3>();
  if (!(std::abs(left.determinant()) > 1e-18)) return std::nullopt;
  Pinhole camera;
  const Vector3d place = -left.inverse() * normalized.col(3);
  camera.eye = unit.mean + unit.size * place;
  double in_front = 0.0;
  for (const Point& point : points) {
    in_front += left.row(2).dot(point.world - camera.eye) > 0.0 ? 1.0 : -1.0;
  }
  if (in_front < 0.0) left = -left;
  // From below: forward, then what is perpendicular to it.
  const Vector3d forward = left.row(2).transpose();
  const double w = forward.norm();
  const Vector3d f = forward / w;
  Vector3d down = left.row(1).transpose() - f * f.dot(left.row(1).transpose());
  const double fy = down.norm() / w;
  down.normalize();
  Vector3d right = left.row(0).transpose() - f * f.dot(left.row(0).transpose());
  right -= down * down.dot(right);
  const double fx = right.norm() / w;
  right.normalize();
  camera.rotation.row(0) = right.transpose();
  camera.rotation.row(1) = down.transpose();
  camera.rotation.row(2) = f.transpose();
  camera.focal = 0.5 * (fx + fy) * unit.half_width;
  camera.center = unit.center;
  if (!(camera.focal > 0.0) || !camera.eye.allFinite()) return std::nullopt;
  return camera;
}

// Distance in pixels between where a point is seen and where it should be; infinite behind.
Vector2d error_of(const Pinhole& camera, const Point& point, Vector3d& view) {
  view = camera.rotation * (point.world - camera.eye);
  if (view[2] <= 1e-9 * view.norm()) return Vector2d::Constant(1e6);
  return camera.focal * view.head<2>() / view[2] + camera.center - point.pixel;
}

double median_error(const Pinhole& camera, const std::vector<Point>& points) {
  std::vector<double> errors;
  Vector3d view;
  for (const Point& point : points) errors.push_back(error_of(camera, point, view).norm());
  return median(std::move(errors));
}

// Rotation, eye, log focal length and center, in that order.
using Jacobian = Eigen::Matrix<double, 2, 9>;

Jacobian jacobian_of(const Pinhole& camera, const Vector3d& view) {
  const double z = view[2];
  Eigen::Matrix<double, 2, 3> by_view;
  by_view << camera.focal / z, 0.0, -camera.focal * view[0] / (z * z), 0.0, camera.focal / z,
      -camera.focal * view[1] / (z * z);
  Matrix3d cross;  // view' = view + turn x view
  cross << 0.0, view[2], -view[1], -view[2], 0.0, view[0], view[1], -view[0], 0.0;
  Jacobian jacobian;
  jacobian.leftCols<3>() = by_view * cross;
  jacobian.middleCols<3>(3) = -by_view * camera.rotation;
  jacobian.col(6) = camera.focal * view.head<2>() / z;
  jacobian.rightCols<2>() = Eigen::Matrix2d::Identity();
  return jacobian;
}

// One step of Gauss-Newton with Cauchy's weights; the last `fixed` unknowns stay.
void step(Pinhole& camera, const std::vector<Point>& points, int fixed) {
  const double width = std::max(0.05, 2.0 * median_error(camera, points));
  Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> side = Eigen::Matrix<double, 9, 1>::Zero();
  for (const Point& point : points) {
    Vector3d view;
    const Vector2d error = error_of(camera, point, view);
    if (error[0] >= 1e6) continue;
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (width * width));
    const Jacobian jacobian = jacobian_of(camera, view);
    square.noalias() += weight * jacobian.transpose() * jacobian;
    side.noalias() -= weight * jacobian.transpose() * error;
  }
  const int free = 9 - fixed;
  const Eigen::VectorXd scale =
      (square.diagonal().head(free).array() + 1e-30).sqrt().inverse().matrix();
  Eigen::MatrixXd scaled =
      scale.asDiagonal() * square.topLeftCorner(free, free) * scale.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  Eigen::Matrix<double, 9, 1> change = Eigen::Matrix<double, 9, 1>::Zero();
  change.head(free) = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(side.head(free))));
  const Vector3d turn = change.head<3>();
  const double angle = turn.norm();
  if (angle > 0.0) camera.rotation = Eigen::AngleAxisd(angle, turn / angle) * camera.rotation;
  camera.eye += change.segment<3>(3);
  camera.focal *= std::exp(std::clamp(change[6], -1.0, 1.0));
  camera.center += change.tail<2>();
}

struct Quality {
  double residual = 0.0, outliers = 1.0;
};

Quality quality_of(const Pinhole& camera, const std::vector<Point>& points) {
  const double limit = std::max(1.0, 4.0 * median_error(camera, points));
  double sum = 0.0, fitting = 0.0;
  Vector3d view;
  for (const Point& point : points) {
    const double squared = error_of(camera, point, view).squaredNorm();
    if (squared > limit * limit) continue;
    sum += squared;
    ++fitting;
  }
  const double count = static_cast<double>(points.size());
  return {std::sqrt(sum / std::max(fitting, 1.0)), 1.0 - fitting / count};
}

bool is_view_space(const Pinhole& camera, const std::vector<Point>& points) {
  double distance = 0.0;
  for (const Point& point : points) {
    distance += (point.world - camera.eye).norm() / static_cast<double>(points.size());
  }
  if (camera.eye.norm() > 1e-3 * distance) return false;
  return camera.rotation.cwiseAbs().diagonal().minCoeff() > 0.99999 && camera.rotation(0, 0) > 0.0;
}

Camera to_camera(const Pinhole& pinhole) {
  Camera camera;
  for (int row = 0; row < 3; ++row) {
    camera.eye[row] = static_cast<float>(pinhole.eye[row]);
    for (int column = 0; column < 3; ++column) {
      camera.world_to_view[column][row] = static_cast<float>(pinhole.rotation(row, column));
    }
  }
  camera.focal = static_cast<float>(pinhole.focal);
  camera.center = {static_cast<float>(pinhole.center[0]), static_cast<float>(pinhole.center[1])};
  return camera;
}

}  // namespace

std::optional<CameraFit> solve_camera(const Planes<3>& position, const Plane<float>& depth) {
  const Extent extent = position[0].extent();
  check_extent(extent);
  EL_CHECK(depth.empty() || depth.extent() == extent, "camera: positions are {}x{}, depth {}x{}",
           extent.width, extent.height, depth.width(), depth.height());
  const std::vector<Point> points = sample_points(position, depth);
  if (points.size() < kFewest) return std::nullopt;
  Normalization unit;
  if (!normalize(points, extent, unit)) return std::nullopt;
  auto camera = decompose(solve_projection(points, unit), points, unit);
  if (!camera) return std::nullopt;
  for (int i = 0; i < 12; ++i) step(*camera, points, 2);
  Quality quality = quality_of(*camera, points);
  Pinhole shifted = *camera;
  for (int i = 0; i < 12; ++i) step(shifted, points, 0);
  const Quality other = quality_of(shifted, points);
  if (other.residual < kShiftGain * quality.residual ||
      other.outliers < 0.5 * quality.outliers - 0.01) {
    camera = shifted;
    quality = other;
  }
  if (!(quality.residual < kWorstResidual) || quality.outliers > 0.5) return std::nullopt;
  return CameraFit{to_camera(*camera), quality.residual, quality.outliers,
                   is_view_space(*camera, points)};
}

}  // namespace eigenlight
