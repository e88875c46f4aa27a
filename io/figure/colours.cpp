#include "io/figure/colours.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace chladni::io {
namespace {

// CIELAB (D65, 2 degrees), as IEC 61966-2-1 and CIE 15 define it.
using Lab = Eigen::Vector3d;

double linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
double encoded(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

Eigen::Matrix3d xyz_of_rgb() {
  Eigen::Matrix3d matrix;
  matrix << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  return matrix;
}

// The coordinates of white are those of (1, 1, 1), so that white converts back to white.
Lab lab(const Colour& colour) {
  const Eigen::Vector3d rgb(linear(colour[0]), linear(colour[1]), linear(colour[2]));
  const Eigen::Vector3d white = xyz_of_rgb() * Eigen::Vector3d::Ones();
  const Eigen::Vector3d f = (xyz_of_rgb() * rgb).cwiseQuotient(white).unaryExpr([](double t) {
    return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
  });
  return {116.0 * f.y() - 16.0, 500.0 * (f.x() - f.y()), 200.0 * (f.y() - f.z())};
}

Colour rgb(const Lab& lab) {
  const double fy = (lab(0) + 16.0) / 116.0;
  const Eigen::Vector3d f(fy + lab(1) / 500.0, fy, fy - lab(2) / 200.0);
  const Eigen::Vector3d white = xyz_of_rgb() * Eigen::Vector3d::Ones();
  const Eigen::Vector3d xyz =
      f.unaryExpr([](double t) {
         return t > 6.0 / 29.0 ? t * t * t : (116.0 * t - 16.0) * 27.0 / 24389.0;
       }).cwiseProduct(white);
  const Eigen::Vector3d rgb = xyz_of_rgb().inverse() * xyz;
  const auto channel = [&](Eigen::Index i) { return std::clamp(encoded(rgb(i)), 0.0, 1.0); };
  return {channel(0), channel(1), channel(2)};
}

// The colour at `part_of_way`, in [0, 1], between five colours at even distances.
Colour between(const std::array<Colour, 5>& steps, double part_of_way) {
  const double place = 4.0 * std::min(part_of_way, 1.0);
  const auto step = static_cast<std::size_t>(std::min(place, 3.0));
  const double part = place - static_cast<double>(step);
  return rgb((1.0 - part) * lab(steps[step]) + part * lab(steps[step + 1]));
}

}  // namespace

Colour diverging(double value) {
  // |value| = 0, 1/4, 1/2, 3/4, 1
  static const std::array<Colour, 5> red{{{1.0, 1.0, 1.0},
                                          {0.992, 0.859, 0.780},
                                          {0.957, 0.647, 0.510},
                                          {0.839, 0.376, 0.302},
                                          {0.698, 0.094, 0.169}}};
  static const std::array<Colour, 5> blue{{{1.0, 1.0, 1.0},
                                           {0.820, 0.898, 0.941},
                                           {0.573, 0.773, 0.871},
                                           {0.263, 0.576, 0.765},
                                           {0.129, 0.400, 0.675}}};
  return between(value < 0.0 ? blue : red, std::abs(value));
}

Colour sequential(double value) {
  static const std::array<Colour, 5> steps{{{0.267, 0.005, 0.329},
                                            {0.229, 0.322, 0.545},
                                            {0.128, 0.567, 0.551},
                                            {0.369, 0.789, 0.383},
                                            {0.993, 0.906, 0.144}}};
  return between(steps, std::max(value, 0.0));
}

Colour categorical(int number) {
  static const std::array<Colour, kCategories> colours{{{0.553, 0.827, 0.780},
                                                        {1.000, 1.000, 0.702},
                                                        {0.745, 0.729, 0.855},
                                                        {0.984, 0.502, 0.447},
                                                        {0.502, 0.694, 0.827},
                                                        {0.992, 0.706, 0.384},
                                                        {0.702, 0.871, 0.412},
                                                        {0.988, 0.804, 0.898},
                                                        {0.851, 0.851, 0.851},
                                                        {0.737, 0.502, 0.741},
                                                        {0.800, 0.922, 0.773},
                                                        {1.000, 0.929, 0.435}}};
  return colours[static_cast<std::size_t>(number) % kCategories];
}

}  // namespace chladni::io
