#include <cmath>
#include <functional>
#include <numeric>

#include "core/errors.hpp"
#include "state/state.hpp"

namespace valsalva::state {
namespace {

std::size_t product(const std::vector<std::size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

template <class T>
const std::vector<T>& held(const Array& array, const std::string& what, const char* type) {
  if (const auto* values = std::get_if<std::vector<T>>(&array.data)) return *values;
  throw InputError("state entry '{}': expected {} values; the file was not written by this version", what,
                   type);
}

template <class T>
Array with_shape(std::vector<T> values, std::vector<std::size_t> shape) {
  VALSALVA_ASSERT(product(shape) == values.size());
  Array array;
  array.shape = std::move(shape);
  array.data = std::move(values);
  return array;
}

}  // namespace

Array Array::scalar(double value) {
  return with_shape(std::vector<double>{value}, {1});
}
Array Array::of(std::vector<double> values) {
  const std::size_t n = values.size();
  return with_shape(std::move(values), {n});
}
Array Array::of(std::vector<std::int64_t> values) {
  const std::size_t n = values.size();
  return with_shape(std::move(values), {n});
}
Array Array::of(std::vector<double> values, std::vector<std::size_t> shape) {
  return with_shape(std::move(values), std::move(shape));
}
Array Array::of(std::vector<float> values, std::vector<std::size_t> shape) {
  return with_shape(std::move(values), std::move(shape));
}

Array Array::of(const Points& points) {
  std::vector<double> values;
  values.reserve(3 * points.size());
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return with_shape(std::move(values), {points.size(), 3});
}

std::size_t Array::size() const {
  return product(shape);
}

const std::vector<double>& Array::doubles(const std::string& what) const {
  return held<double>(*this, what, "double");
}
const std::vector<float>& Array::floats(const std::string& what) const {
  return held<float>(*this, what, "float");
}
const std::vector<std::int64_t>& Array::integers(const std::string& what) const {
  return held<std::int64_t>(*this, what, "integer");
}

double Array::number(const std::string& what) const {
  if (size() != 1) throw InputError("state entry '{}': expected one number, found {} values", what, size());
  return doubles(what).front();
}

Points Array::points(const std::string& what) const {
  if (shape.size() != 2 || shape[1] != 3)
    throw InputError("state entry '{}': expected n x 3 coordinates, found another shape", what);
  const std::vector<double>& values = doubles(what);
  Points result(shape[0]);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  return result;
}

}  // namespace valsalva::state
