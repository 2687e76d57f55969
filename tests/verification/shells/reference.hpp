// Rows of the published numbers, as texts; empty when the file is not there.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace valsalva {

inline std::vector<std::vector<std::string>> reference_rows(const std::string& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(std::string(VALSALVA_REFERENCE) + "/" + file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    rows.push_back(row);
  }
  if (!rows.empty()) rows.erase(rows.begin());  // the header
  return rows;
}

}  // namespace valsalva

#define VALSALVA_NEEDS(rows) \
  if ((rows).empty()) GTEST_SKIP() << "the reference numbers are not in " << VALSALVA_REFERENCE
