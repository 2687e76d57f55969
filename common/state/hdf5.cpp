#include "state/hdf5.hpp"

#include <algorithm>

namespace valsalva::state::hdf5 {
namespace {

constexpr hsize_t smallest_compressed = 4096;  // values; below this, chunks cost more than they save

template <class T>
hid_t native();
template <>
hid_t native<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t native<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t native<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

Handle simple_space(const std::vector<hsize_t>& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, "dataspace"};
}

template <class T>
void write_values(hid_t parent, const std::string& name, const std::vector<std::size_t>& shape,
                  const std::vector<T>& values) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  const Handle space = simple_space(sizes);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  check(H5Pset_obj_track_times(properties, 0), name);  // equal content gives equal files
  if (values.size() >= smallest_compressed) {
    std::vector<hsize_t> chunk = sizes;
    // Whole rows, about half a million values a chunk.
    const hsize_t row = values.size() / std::max<hsize_t>(1, sizes[0]);
    chunk[0] = std::clamp<hsize_t>((1u << 19) / std::max<hsize_t>(1, row), 1, sizes[0]);
    check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), name);
    check(H5Pset_shuffle(properties), name);
    check(H5Pset_deflate(properties, 1), name);
  }
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, name);
  check(H5Pset_create_intermediate_group(links, 1), name);
  Handle dataset(H5Dcreate2(parent, name.c_str(), native<T>(), space, links, properties, H5P_DEFAULT),
                 H5Dclose, name);
  if (!values.empty())
    check(H5Dwrite(dataset, native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  dataset.close(name);
}

struct OpenDataset {
  Handle dataset;
  std::vector<std::size_t> shape;
};

OpenDataset open_dataset(hid_t parent, const std::string& name) {
  Handle dataset(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), H5Dclose, name);
  const Handle space(H5Dget_space(dataset), H5Sclose, name);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) throw Hdf5Failure(name);
  std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return {std::move(dataset), {sizes.begin(), sizes.end()}};
}

template <class T>
std::vector<T> read_values(const OpenDataset& open, const std::string& name) {
  std::size_t count = 1;
  for (const std::size_t n : open.shape) count *= n;
  std::vector<T> values(count);
  if (count) check(H5Dread(open.dataset, native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  return values;
}

template <class T>
void write_numbers(hid_t object, const std::string& name, const std::vector<T>& values, bool is_scalar) {
  const Handle space =
      is_scalar ? Handle(H5Screate(H5S_SCALAR), H5Sclose, name) : simple_space({values.size()});
  const Handle attribute(H5Acreate2(object, name.c_str(), native<T>(), space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, name);
  check(H5Awrite(attribute, native<T>(), values.data()), name);
}

template <class T>
std::vector<T> read_numbers(hid_t object, const std::string& name) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  const auto count = H5Sget_simple_extent_npoints(space);
  if (count < 1) throw Hdf5Failure(name);
  std::vector<T> values(static_cast<std::size_t>(count));
  check(H5Aread(attribute, native<T>(), values.data()), name);
  return values;
}

}  // namespace

Handle::Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
  if (id_ < 0) throw Hdf5Failure(what);
}

Handle::~Handle() {
  if (id_ >= 0) close_(id_);
}

void Handle::close(const std::string& what) {
  const hid_t id = std::exchange(id_, -1);
  if (id >= 0) check(close_(id), what);
}

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Quiet::~Quiet() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

void check(herr_t result, const std::string& what) {
  if (result < 0) throw Hdf5Failure(what);
}

Handle create_file(const std::string& path) {
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "create"};
}
Handle create_file_in_memory() {
  constexpr std::size_t growth = 1u << 24;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "create");
  check(H5Pset_fapl_core(access, growth, /*backing_store=*/0), "create");
  return {H5Fcreate("state", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "create"};
}

std::string image_of(hid_t file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Hdf5Failure("image");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size) throw Hdf5Failure("image");
  return bytes;
}

Handle open_file(const std::string& path) {
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open"};
}
Handle create_group(hid_t parent, const std::string& name) {
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, name};
}
Handle open_group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, name};
}

bool exists(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> names(hid_t group) {
  std::vector<std::string> found;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->push_back(name);
    return 0;
  };
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &found), "group");
  return found;
}

bool is_group(hid_t parent, const std::string& name) {
  const Handle object(H5Oopen(parent, name.c_str(), H5P_DEFAULT), H5Oclose, name);
  return H5Iget_type(object) == H5I_GROUP;
}

void write_array(hid_t parent, const std::string& name, const Array& array) {
  std::visit([&](const auto& values) { write_values(parent, name, array.shape, values); }, array.data);
}

Array read_array(hid_t parent, const std::string& name) {
  const OpenDataset open = open_dataset(parent, name);
  const Handle type(H5Dget_type(open.dataset), H5Tclose, name);
  Array array;
  array.shape = open.shape;
  if (H5Tget_class(type) == H5T_INTEGER)
    array.data = read_values<std::int64_t>(open, name);
  else if (H5Tget_size(type) == sizeof(float))
    array.data = read_values<float>(open, name);
  else
    array.data = read_values<double>(open, name);
  return array;
}

void write_bytes(hid_t parent, const std::string& name, const std::vector<std::uint8_t>& values) {
  write_values(parent, name, {values.size()}, values);
}

bool is_bytes(hid_t parent, const std::string& name) {
  const OpenDataset open = open_dataset(parent, name);
  const Handle type(H5Dget_type(open.dataset), H5Tclose, name);
  return H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) == 1;
}

std::vector<std::uint8_t> read_bytes(hid_t parent, const std::string& name) {
  return read_values<std::uint8_t>(open_dataset(parent, name), name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name);
  check(H5Tset_size(type, std::max<std::size_t>(1, text.size())), name);
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         name);
  check(H5Awrite(attribute, type, text.empty() ? "\0" : text.data()), name);
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_numbers(object, name, std::vector<double>{value}, true);
}
void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_numbers(object, name, std::vector<std::int64_t>{value}, true);
}
void write_attribute(hid_t object, const std::string& name, const std::vector<std::int64_t>& values) {
  write_numbers(object, name, values, false);
}
void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values) {
  write_numbers(object, name, values, false);
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, name);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) throw Hdf5Failure(name);
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), name);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

double read_real_attribute(hid_t object, const std::string& name) {
  return read_numbers<double>(object, name).front();
}
std::int64_t read_integer_attribute(hid_t object, const std::string& name) {
  return read_numbers<std::int64_t>(object, name).front();
}
std::vector<double> read_reals_attribute(hid_t object, const std::string& name) {
  return read_numbers<double>(object, name);
}
bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

}  // namespace valsalva::state::hdf5
