// The report page: one self-contained HTML text from what a run left behind.
#pragma once

#include <string>

#include "run_data.hpp"

namespace valsalva::report {

struct PageOptions {
  std::string title;        ///< one line below the case's name; may be empty
  int picture_width = 680;  ///< pixels of a still picture
  int viewer_frames = 40;   ///< at most so many frames of the beat in the interactive view
};

/// Opens offline: a content-security policy in the page forbids every request.
std::string page(const RunData& run, const PageOptions& options);

/// <head> and what every page of ours begins with; the page's own body follows, then `page_end`.
std::string page_begin(const std::string& title, const std::string& description);
std::string page_end();

}  // namespace valsalva::report
