// Files of solids: what is read, what is refused and by which words, and what is kept of them.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/lattice/lattice.h"
#include "lattice/shapes_file.h"
#include "solid/parts_file.h"
#include "solid/surface.h"
#include "support/solids.h"

namespace floe::test {
namespace {

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Returns the message by which a file is refused.
std::string refusal(const std::string& path) {
  try {
    check_surface(read_surface(path, 1, "file"), "file: '" + path + "'");
  } catch (const InputError& error) {
    const std::string text = error.what(), start = "file: '" + path + "': ";
    EXPECT_TRUE(text.starts_with(start)) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return text.substr(std::min(start.size(), text.size()));
  }
  return "";
}
std::string refusal_of(const Surface& surface) {
  write_obj(surface, "bad.obj");
  return refusal("bad.obj");
}

TEST(SolidFiles, AllKindsAreReadAlike) {
  const Surface solid = l_shape();
  write_obj(solid, "l.obj");
  write_text_stl(solid, "l.stl");
  write_bytes(binary_stl(solid), "L.STL");  // begins with "solid" as well
  write_bytes(
      "# polygons, in clauses of all kinds\nmtllib none\no L\n"
      "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
      "v 0 0 1.5\r\nv 3 0 1.5\nv 3 1 1.5\nv 1 1 1.5\nv 1 2 1.5\nv 0 2 1.5 1\nvt 0 0\nvn 0 0 1\n"
      "f 6 5 4 3 2 1\nf 7 8 9 \\\n10 11 12\nf 1/1/1 2/1/1 8 7\nf 2//1 3 9 8\nf 3 4 10 9\n"
      "f 4 5 11 10\nf 5 6 12 11\nf 6 -12 -6 12\n",
      "polygons.obj");
  for (const char* path : {"l.obj", "l.stl", "L.STL", "polygons.obj"}) {
    const Surface read = read_surface(path, 0.5, "file");
    EXPECT_EQ(read.vertices.size(), 12) << path;
    EXPECT_EQ(read.triangles.size(), 20) << path;
    EXPECT_NEAR(volume_of(read), 6.0 / 8, 1e-14) << path;
    check_surface(read, path);
  }
}

TEST(SolidFiles, BadFilesAreRefused) {
  const std::string good = binary_stl(box(1, 1, 1));
  EXPECT_EQ(refusal("none.stl"), "cannot be read");
  std::filesystem::create_directory("folder.stl");
  EXPECT_EQ(refusal("folder.stl"), "is not a regular file");
  ASSERT_EQ(mkfifo("pipe.stl", 0600), 0);
  EXPECT_EQ(refusal("pipe.stl"), "is not a regular file");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"a.ply|" + good, "must end in .stl or .obj"},
      {"empty.stl|", "is no STL file, or incomplete: it has 0 bytes"},
      {"cut.stl|" + good.substr(0, 300), "is incomplete: 12 triangles are 684 bytes, it has 300"},
      {"long.stl|" + good + "x", "has 685 bytes, 12 triangles of a binary STL file are 684"},
      {"count.stl|" + good.substr(0, 80) + std::string("\x41\x42\x0f\x00", 4) + good.substr(84),
       "tells of 1000001 triangles, at most 1000000 are read"},
      {"none.obj|# nothing\n", "has no triangle"},
      {"word.stl|solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", "line 4: x is no number"},
      {"three.stl|solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n",
       "line 5: a facet must have 3 vertices"},
      {"end.stl|solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n",
       "is incomplete: endsolid is missing"},
      {"other.stl|solid\nhallo\n", "line 2: hallo is no word of an STL file"},
      {"corner.obj|v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
       "line 4: corner 4: there are 3 vertices above"},
      {"zero.obj|v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4: corner 0: there are 3 vertices"},
      {"nan.obj|v 0 nan 0\n", "line 1 has a coordinate that is not finite or above 1e9 m in size"},
      {"far.obj|v 0 0 0\nv 0 1e300 0\n", "line 2 has a coordinate that is not finite or above"},
      {"two.obj|v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: a face must have 3 corners or more"},
  };
  for (const auto& [file, part] : cases) {
    const auto bar = file.find('|');
    write_bytes(file.substr(bar + 1), file.substr(0, bar));
    const std::string said = refusal(file.substr(0, bar));
    EXPECT_NE(said.find(part), std::string::npos) << file.substr(0, bar) << ": " << said;
  }
  Surface infinite = box(1, 1, 1);
  infinite.vertices[3].z = std::numeric_limits<double>::infinity();
  write_bytes(binary_stl(infinite), "inf.stl");
  EXPECT_NE(refusal("inf.stl").find("has a coordinate that is not finite"), std::string::npos);
}

TEST(SolidFiles, BadSurfacesAreRefused) {
  const auto expect = [](const Surface& surface, const std::string& part) {
    const std::string said = refusal_of(surface);
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  const Surface good = box(1, 1, 1);
  EXPECT_EQ(refusal_of(good), "");

  Surface open = good;
  open.triangles.pop_back();
  expect(open, "the surface is open: the edge from (");
  expect(open, " (line ");

  Surface inside_out = good;
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  expect(inside_out, "the surface is inside out: its volume is -1 m3; triangles must be");
  Surface one_turned = good;
  std::swap(one_turned.triangles[0][0], one_turned.triangles[0][1]);
  expect(one_turned, "are turned opposite ways, at the edge from ");

  Surface thin = good;
  thin.vertices.push_back({0.5, 0, 0});
  thin.triangles.push_back({0, 1, 8});
  expect(thin, "triangle 13 (line 22) at (0, 0, 0) m has no area");

  Surface fin = good;  // two boxes that share an edge
  add(fin, good, {1, 1, 0});
  expect(fin, "is in 4 triangles, must be in two: triangle ");

  Surface crossing = good;
  add(crossing, good, {0.5, 0.3, 0.2});
  expect(crossing, "two closed surfaces of the file intersect or touch: triangle ");
  Surface touching = good;
  add(touching, good, {1, 0.3, 0.2});
  expect(touching, "two closed surfaces of the file intersect or touch: triangle ");
  Surface folded = prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 1);
  folded.vertices[9].z = -1;  // a corner of the top, through the bottom
  expect(folded, "the surface intersects or touches itself: triangle ");

  Surface nested = box(3, 3, 3);
  add(nested, good, {1, 1, 1});
  expect(nested, "a closed surface lies inside another, so that they overlap: that of triangle 13");
  Surface hollow = box(3, 3, 3);
  add(hollow, inside_out, {1, 1, 1});
  expect(hollow, "has a cavity, must be solid: that of triangle 13");
  Surface beside = box(3, 3, 3);
  add(beside, inside_out, {5, 1, 1});
  expect(beside, "one of its 2 closed surfaces is inside out: that of triangle 13");
}

TEST(SolidFiles, PartsFilesAreShapes) {
  write_obj(l_shape(), "l.obj");
  const SolidFile solid{"l.obj", 2, 0, 10};
  const ConvexParts parts = parts_of(solid, "file", std::string());
  EXPECT_NEAR(parts.volume, 48, 1e-11);
  write_parts(parts, "l.h5");
  const Shapes shapes = read_polyhedra("l.h5", "file");
  EXPECT_EQ(shapes.bodies(), 2);
  EXPECT_TRUE(shapes.vertices == parts.shapes.vertices);
  write_obj(box(1, 2, 3), "box.obj");
  write_parts(parts_of({"box.obj", 1, 0, 10}, "file", std::string()), "box.h5");
  EXPECT_NEAR(volume_properties(read_polyhedra("box.h5", "file"), 0).volume, 6, 1e-14);
  EXPECT_EQ(read_polyhedra("box.h5", "file").bodies(), 1);
}

TEST(SolidFiles, KeptPartsHaveTheSameBits) {
  const auto files = [] {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator("kept"))
      found.push_back(entry.path().string());
    return found;
  };
  write_obj(turned(ring(8, 1, 2, 1)), "ring.obj");
  const SolidFile solid{"ring.obj", 1, 0, 100};
  const ConvexParts made = parts_of(solid, "file", "kept");
  ASSERT_EQ(files().size(), 1);
  const std::string file = files()[0], bytes = contents(file);
  const auto expect_same = [&](const ConvexParts& parts) {
    EXPECT_TRUE(parts.shapes.vertices == made.shapes.vertices);
    EXPECT_EQ(parts.shapes.corners, made.shapes.corners);
    EXPECT_EQ(parts.shapes.corner_of, made.shapes.corner_of);
    EXPECT_EQ(parts.shapes.face_of, made.shapes.face_of);
    EXPECT_EQ(parts.shapes.vertex_of, made.shapes.vertex_of);
    EXPECT_EQ(parts.triangles, made.triangles);
    EXPECT_EQ(parts.volume, made.volume);
    EXPECT_EQ(parts.parts_volume, made.parts_volume);
    EXPECT_EQ(parts.distance, made.distance);
  };
  const auto written = std::filesystem::last_write_time(file);
  expect_same(parts_of(solid, "file", "kept"));
  EXPECT_EQ(std::filesystem::last_write_time(file), written);  // it was taken from there

  std::string damaged = bytes;
  damaged[bytes.size() / 2] = static_cast<char>(damaged[bytes.size() / 2] ^ 1);
  for (const std::string& bad : {damaged, bytes.substr(0, 1000), std::string()}) {
    write_bytes(bad, file);
    expect_same(parts_of(solid, "file", "kept"));
    EXPECT_EQ(contents(file).size(), bytes.size());  // made anew
  }
  // Each argument has a file of its own, and a changed solid too.
  parts_of({"ring.obj", 2, 0, 100}, "file", "kept");
  parts_of({"ring.obj", 1, 0.01, 100}, "file", "kept");
  parts_of({"ring.obj", 1, 0, 101}, "file", "kept");
  EXPECT_EQ(files().size(), 4);
  write_obj(ring(8, 1, 2, 2), "ring.obj");
  EXPECT_NEAR(parts_of(solid, "file", "kept").volume, 2 * made.volume, 1e-11);
  EXPECT_EQ(files().size(), 5);
  // A folder that cannot be made is no error.
  expect_same([&] {
    write_obj(turned(ring(8, 1, 2, 1)), "ring.obj");
    return parts_of(solid, "file", "ring.obj/below");
  }());
}

}  // namespace
}  // namespace floe::test
