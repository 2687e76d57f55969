// The thin layer over the HDF5 C interface: handles that close themselves, typed reads and writes.
// An HDF5 error becomes an Hdf5Failure, which callers turn into the user's error.
#pragma once

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "state/state.hpp"

namespace valsalva::state::hdf5 {

struct Hdf5Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Owns an identifier of any kind (file, group, dataset, ...).
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close, const std::string& what);
  ~Handle();
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  /// Closes now and reports a failure, which a destructor could not.
  void close(const std::string& what);

 private:
  hid_t id_;
  Close close_;
};

/// No error stack on stderr while an object of this class lives: our messages say it better.
class Quiet {
 public:
  Quiet();
  ~Quiet();

 private:
  H5E_auto2_t function_;
  void* data_;
};

void check(herr_t result, const std::string& what);

Handle create_file(const std::string& path);
/// A file that lives in memory only; image_of gives the bytes that a file on disk would have. HDF5 cannot let
/// go of a file that it failed to flush (it crashes at exit), so what may meet a full disk is not left to it.
Handle create_file_in_memory();
std::string image_of(hid_t file);
Handle open_file(const std::string& path);
Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);
bool exists(hid_t parent, const std::string& name);
/// Names of the links in a group, sorted.
std::vector<std::string> names(hid_t group);
bool is_group(hid_t parent, const std::string& name);

/// Groups on the way ("group/name") are made.
void write_array(hid_t parent, const std::string& name, const Array& array);
Array read_array(hid_t parent, const std::string& name);
void write_bytes(hid_t parent, const std::string& name, const std::vector<std::uint8_t>& values);
bool is_bytes(hid_t parent, const std::string& name);
std::vector<std::uint8_t> read_bytes(hid_t parent, const std::string& name);

/// Fixed-length ASCII of exactly its length: what the VTKHDF reader asks of its Type attribute.
void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::int64_t>& values);
void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values);
std::string read_text_attribute(hid_t object, const std::string& name);
double read_real_attribute(hid_t object, const std::string& name);
std::int64_t read_integer_attribute(hid_t object, const std::string& name);
std::vector<double> read_reals_attribute(hid_t object, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);

}  // namespace valsalva::state::hdf5
