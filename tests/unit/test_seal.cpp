// No bit of a sealed file can change unseen; a file of a given name is never gone while it gets a
// second one.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "files/files.h"
#include "files/hdf5.h"
#include "files/seal.h"
#include "floe/base/petsc.h"

namespace floe::test {
namespace {

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Seal, EveryFlippedBitIsSeen) {
  const std::string path = "sealed", good = std::string(seal_size, 'x') + std::string("\0\1ab", 4);
  write(path, good);
  EXPECT_NE(seal_problem(path), "");
  seal(path);
  ASSERT_EQ(seal_problem(path), "");
  const std::string sealed = contents(path);
  EXPECT_EQ(sealed.substr(seal_size), good.substr(seal_size));
  for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    std::string bad = sealed;
    bad[bit / 8] = static_cast<char>(static_cast<unsigned char>(bad[bit / 8]) ^ (1U << (bit % 8)));
    write(path, bad);
    ASSERT_NE(seal_problem(path), "") << "bit " << bit;
  }
  for (std::size_t size = 0; size < sealed.size(); ++size) {
    write(path, sealed.substr(0, size));
    ASSERT_NE(seal_problem(path), "") << size << " bytes";
  }
  write(path, sealed + '\0');
  EXPECT_NE(seal_problem(path), "");
}

TEST(Seal, FitsIntoHdf5) {
  const std::string path = "sealed.h5";
  Hdf5File file = Hdf5File::create(path, seal_size);
  const std::vector<double> values{1, 2, 3};
  file.write("a/b", values);
  file.close([](const std::string& temporary, const std::string& name) {
    seal(temporary);
    EXPECT_FALSE(std::filesystem::exists(name));
    put_in_place(temporary, name);
  });
  EXPECT_EQ(seal_problem(path), "");
  EXPECT_EQ(Hdf5File::open(path).read("a/b"), values);
}

TEST(Seal, AFileThatIsNotPutInPlaceGoes) {
  std::filesystem::create_directory("gone");
  Hdf5File file = Hdf5File::create("gone/never.h5", seal_size);
  EXPECT_THROW(file.close([](const std::string&, const std::string&) { throw FileError("no"); }),
               FileError);
  { const Hdf5File gone = std::move(file); }
  EXPECT_TRUE(std::filesystem::is_empty("gone"));
}

TEST(SecondName, TakesTheNameOfTheFirst) {
  std::filesystem::create_directory("names");
  const std::string first = "names/first", second = "names/second", newer = "names/new";
  give_second_name("names/none", second);
  EXPECT_FALSE(std::filesystem::exists(second));
  write(first, "1");
  for (int again = 0; again < 2; ++again) {  // two names of one file already
    give_second_name(first, second);
    EXPECT_EQ(contents(first), "1");
    EXPECT_EQ(contents(second), "1");
  }
  write(newer, "2");
  put_in_place(newer, first);
  EXPECT_EQ(contents(second), "1");
  give_second_name(first, second);
  EXPECT_EQ(contents(second), "2");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("names"))
    files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 2U);
}

}  // namespace
}  // namespace floe::test
