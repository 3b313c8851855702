#include "support/record.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace floe::test {

void record(const Checked& c, bool pass) {
  const char* folder = std::getenv("FLOE_RECORD");
  if (folder == nullptr || *folder == '\0') return;
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test.test_suite_name()) + "." + test.name() + ".jsonl";
  std::ranges::replace(name, '/', '_');  // of parametrised tests
  const std::string file = std::string(folder) + "/" + name;
  nlohmann::ordered_json line;
  const auto or_null = [](const std::optional<double>& x) {
    return x ? nlohmann::ordered_json(*x) : nlohmann::ordered_json(nullptr);
  };
  line["section"] = c.section;
  line["quantity"] = c.quantity;
  line["value"] = c.value;
  line["reference"] = or_null(c.reference);
  line["tolerance"] = or_null(c.tolerance);
  line["unit"] = c.unit;
  line["note"] = c.note;
  line["pass"] = pass;
  std::ofstream out(file, std::ios::app);
  out << line.dump() << '\n';
  EXPECT_TRUE(out.flush()) << "cannot write " << file;
}

}  // namespace floe::test
