// Expects an error of one kind whose message holds all the given words.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <string>

#include "core/errors.hpp"

namespace valsalva::test {

inline void expect_error(ExitCode code, std::initializer_list<const char*> words,
                         const std::function<void()>& act) {
  try {
    act();
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
    for (const char* word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "'" << word << "' is missing in: " << error.what();
  }
}

}  // namespace valsalva::test
