// The page's parts, built into the program from page/, data/ and the installed three.js.
#pragma once

#include <string>

namespace valsalva::report::assets {

std::string style_css();
std::string page_js();    ///< readings on charts
std::string viewer_js();  ///< the interactive view
std::string published_toml();
std::string three_js();  ///< three.min.js and OrbitControls.js of Debian's libjs-three
std::string three_licence();

}  // namespace valsalva::report::assets
