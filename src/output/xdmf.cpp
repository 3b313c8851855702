#include "output/xdmf.h"

#include <sstream>

namespace floe {
namespace {

/// \param where  FILE:/PATH
std::string item(const std::string& where, const std::string& dimensions, const char* type,
                 int precision) {
  return "<DataItem Format=\"HDF\" NumberType=\"" + std::string(type) + "\" Precision=\"" +
         std::to_string(precision) + "\" Dimensions=\"" + dimensions + "\">" + where +
         "</DataItem>";
}

std::string attribute(const std::string& name, const std::string& group, std::size_t rows,
                      int columns, const char* centre, int precision) {
  const std::string dimensions =
      std::to_string(rows) + (columns > 1 ? " " + std::to_string(columns) : "");
  return "        <Attribute Name=\"" + name + "\" AttributeType=\"" +
         (columns == 3   ? "Vector"
          : columns == 1 ? "Scalar"
                         : "Matrix") +
         "\" Center=\"" + centre + "\">" +
         item(group + "/" + name, dimensions, "Float", precision) + "</Attribute>\n";
}

std::string cracks_grid(const std::string& group, std::size_t cracks) {
  const std::string faces = std::to_string(cracks);
  return "      <Grid Name=\"cracks\">\n        <Topology TopologyType=\"Quadrilateral\" "
         "NumberOfElements=\"" +
         faces + "\">" + item(group + "/cracks", faces + " 4", "Int", 4) +
         "</Topology>\n        <Geometry GeometryType=\"XYZ\">" +
         item(group + "/crack_points", std::to_string(4 * cracks) + " 3", "Float", 8) +
         "</Geometry>\n        <Attribute Name=\"beam\" AttributeType=\"Scalar\" Center=\"Cell\">" +
         item(group + "/crack_beam", faces, "Int", 4) + "</Attribute>\n      </Grid>\n";
}

}  // namespace

std::string xdmf_grid(const GridSizes& sizes, const std::string& mesh_file,
                      const GridPlace& place) {
  const std::string group = place.file + ":" + place.group, mesh = mesh_file + ":/mesh",
                    faces = std::to_string(sizes.faces);
  const std::size_t n = sizes.bodies, m = sizes.beams;
  std::ostringstream out;
  out.precision(17);
  out << "    <Grid Name=\"sheet\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
      << "      <Time Value=\"" << place.time << "\"/>\n"
      << "      <Grid Name=\"bodies\">\n        <Topology TopologyType=\""
      << (sizes.shapes ? "Mixed" : "Polyvertex\" NodesPerElement=\"1") << "\" NumberOfElements=\""
      << faces << "\">" << item(mesh + "/topology", std::to_string(sizes.topology), "Int", 4)
      << "</Topology>\n"
      << "        <Geometry GeometryType=\"XYZ\">"
      << item(group + "/points", std::to_string(sizes.points) + " 3", "Float", 8)
      << "</Geometry>\n        <Attribute Name=\"body\" AttributeType=\"Scalar\" Center=\"Cell\">"
      << item(mesh + "/body", faces, "Int", 4) << "</Attribute>\n"
      << attribute("face_displacement", group, sizes.faces, 3, "Cell", 4)
      << attribute("face_rotation", group, sizes.faces, 3, "Cell", 4) << "      </Grid>\n";
  if (m > 0) {
    out << "      <Grid Name=\"beams\">\n        <Topology TopologyType=\"Polyline\" "
           "NodesPerElement=\"2\" "
        << "NumberOfElements=\"" << m << "\">"
        << item(mesh + "/beams", std::to_string(m) + " 2", "Int", 4)
        << "</Topology>\n        <Geometry GeometryType=\"XYZ\">"
        << item(group + "/centres", std::to_string(n) + " 3", "Float", 8) << "</Geometry>\n"
        << attribute("bodies_displacement", group, n, 3, "Node", 8)
        << attribute("bodies_rotation", group, n, 3, "Node", 8)
        << attribute("beams_force", group, m, 3, "Cell", 8)
        << attribute("beams_moment", group, m, 3, "Cell", 8)
        << attribute("tensile_stress", group, m, 1, "Cell", 8)
        << attribute("shear_stress", group, m, 1, "Cell", 8)
        << (place.breakable ? attribute("damage", group, m, 1, "Cell", 8) : "")
        << "      </Grid>\n";
  }
  if (place.cracks > 0) out << cracks_grid(group, place.cracks);
  out << "    </Grid>\n";
  return out.str();
}

std::string xdmf_include(const std::string& file) {
  return "    <xi:include href=\"" + file + "\" xpointer=\"xpointer(/Xdmf/Domain/Grid/Grid)\"/>\n";
}

std::string xdmf_document(const std::string& grids) {
  return "<?xml version=\"1.0\"?>\n"
         "<Xdmf Version=\"3.0\" xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n<Domain>\n"
         "  <Grid Name=\"floe\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         grids + "  </Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace floe
