#include "graph_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/errors.hpp"
#include "library.hpp"

namespace valsalva::stent {
namespace {

class GraphFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::temp_directory_path() / fmt::format("valsalva_{}.json", test->name());
  }
  void TearDown() override { std::filesystem::remove(file_); }
  void write(const std::string& text) const { std::ofstream(file_) << text; }
  std::string refusal(const std::string& text) const {
    write(text);
    try {
      read_graph(file_, 4);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  void refuses(const std::string& text, const std::string& because) const {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(because), std::string::npos) << message;
  }
  std::filesystem::path file_;
};

constexpr const char* head = R"({"format": "valsalva-frame-graph", "section_mm": [0.25, 0.45], )";

TEST_F(GraphFile, RoundTripKeepsEveryCrossingAndSection) {
  const Frame made = build_frame(supra_annular(26).frame);
  write(graph_text(made));
  const Frame read = read_graph(file_, 4);
  ASSERT_EQ(read.crossings, made.crossings);
  ASSERT_EQ(read.beams, made.beams);
  EXPECT_EQ(read.width_mm, made.width_mm);
  EXPECT_EQ(read.depth_mm, made.depth_mm);
  for (int i = 0; i < made.crossings; ++i) EXPECT_EQ(read.nodes[i], made.nodes[i]);
  // Between the rows the graph knows nothing of the profile's own points.
  for (std::size_t i = made.crossings; i < made.nodes.size(); ++i)
    EXPECT_LT((read.nodes[i] - made.nodes[i]).norm(), 0.15);
}

TEST_F(GraphFile, RoundTripOfACylinderIsExact) {
  const Frame made = build_frame(cylinder(20).frame);
  write(graph_text(made));
  const Frame read = read_graph(file_, 4);
  for (std::size_t i = 0; i < made.nodes.size(); ++i)
    EXPECT_LT((read.nodes[i] - made.nodes[i]).norm(), 1e-12);
}

TEST_F(GraphFile, ShiftsTheLowestNodeToZero) {
  write(std::string(head) + R"("nodes_mm": [[5,0,-7],[0,5,-2],[-5,0,-7]], "struts": [[0,1],[1,2,0.3,0.4]]})");
  const Frame frame = read_graph(file_, 2);
  EXPECT_EQ(frame.nodes[0].z(), 0);
  EXPECT_EQ(frame.nodes[1].z(), 5);
  EXPECT_EQ(frame.width_mm, (std::vector<double>{0.25, 0.25, 0.3, 0.3}));
  EXPECT_EQ(frame.depth_mm, (std::vector<double>{0.45, 0.45, 0.4, 0.4}));
}

TEST_F(GraphFile, BadFilesAreRefusedWithThePlace) {
  refuses("{ \"format\": ", "not a JSON file");
  refuses("[1, 2]", "no frame graph");
  refuses(R"({"format": "something"})", "no frame graph");
  refuses(std::string(head) + R"("struts": [[0,1]]})", "no list \"nodes_mm\"");
  refuses(std::string(head) + R"("nodes_mm": [[5,0,0],[0,5]], "struts": [[0,1]]})", "nodes_mm entry 1");
  refuses(std::string(head) + R"("nodes_mm": [[5,0,0],[0,"a",5]], "struts": [[0,1]]})", "nodes_mm entry 1");
  refuses(std::string(head) + R"("nodes_mm": [[5,0,0],[0,5,5]], "struts": [[0,1,2]]})", "struts entry 0");
  refuses(std::string(head) + R"("nodes_mm": [[5,0,0],[0,5,5]], "struts": [[0,-1]]})",
          "node -1 does not exist");
  refuses(std::string(head) + R"("nodes_mm": [[5,0,0],[0,5,5]], "struts": [[0,1.5]]})",
          "expected a node number");
  refuses(R"({"format": "valsalva-frame-graph", "nodes_mm": [[5,0,0],[0,5,5]], "struts": [[0,1]]})",
          "strut 0 has the section 0 x 0 mm");
  EXPECT_THROW(read_graph("/nonexistent.json", 4), InputError);
}

}  // namespace
}  // namespace valsalva::stent
