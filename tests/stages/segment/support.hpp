// Cases from text, temporary folders, and the expectation of an InputError whose message holds certain words.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "core/case.hpp"
#include "core/errors.hpp"
#include "scene/scene.hpp"

namespace valsalva::test {

inline Case case_of(const std::string& text) {
  Schema schema;
  declare_all(schema);
  return Case::from_text(text, "test", schema, Fidelity::standard);
}

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "segment_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

template <class Function>
void expect_input_error(Function&& function, const std::vector<std::string>& words) {
  try {
    function();
    ADD_FAILURE() << "no InputError was thrown; expected one with '" << words.front() << "'";
  } catch (const InputError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

}  // namespace valsalva::test
