// Segments a triangle mesh with CGAL's shape diameter function, at CGAL's default settings for everything but the
// number of clusters.
//
// Usage: sdf_segmentation LEAST_CLUSTERS MOST_CLUSTERS < MESH
//
// MESH is text: the number of vertices and of faces, the coordinates of every vertex, the vertices of every face.
// The output is text: the CPU seconds of the shape diameters, then one line for every number of clusters, which has
// that number, the CPU seconds of the clustering and the segment of every face.
//
// CGAL's segmentation is under the GPL: this program is built and run by the benchmark alone and is part of no
// distribution of Cleave.

#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <stdexcept>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/mesh_segmentation.h>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = Mesh::Face_index;

Mesh read_mesh(std::istream& in) {
    std::size_t vertex_count = 0, face_count = 0;
    in >> vertex_count >> face_count;
    Mesh mesh;
    for (std::size_t i = 0; i < vertex_count; ++i) {
        double x = 0, y = 0, z = 0;
        in >> x >> y >> z;
        mesh.add_vertex({x, y, z});
    }
    for (std::size_t i = 0; i < face_count; ++i) {
        Mesh::size_type a = 0, b = 0, c = 0;
        in >> a >> b >> c;
        if (mesh.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c)) == Mesh::null_face())
            throw std::runtime_error("the surface is not an oriented manifold");
    }
    if (!in) throw std::runtime_error("the mesh cannot be read");
    return mesh;
}

double cpu_seconds_since(std::clock_t start) { return double(std::clock() - start) / CLOCKS_PER_SEC; }

void segment(Mesh& mesh, std::size_t least_clusters, std::size_t most_clusters) {
    const auto diameter = mesh.add_property_map<Face, double>("f:diameter").first;
    const auto label = mesh.add_property_map<Face, std::size_t>("f:label").first;
    std::clock_t start = std::clock();
    CGAL::sdf_values(mesh, diameter);
    std::cout << cpu_seconds_since(start) << '\n';
    for (std::size_t clusters = least_clusters; clusters <= most_clusters; ++clusters) {
        start = std::clock();
        CGAL::segmentation_from_sdf_values(mesh, diameter, label, clusters);
        std::cout << clusters << ' ' << cpu_seconds_since(start);
        for (const Face face : mesh.faces()) std::cout << ' ' << label[face];
        std::cout << '\n';
    }
}

}  // namespace

int main(int argument_count, char** arguments) {
    if (argument_count != 3) {
        std::cerr << "Usage: sdf_segmentation LEAST_CLUSTERS MOST_CLUSTERS < MESH\n";
        return EXIT_FAILURE;
    }
    try {
        Mesh mesh = read_mesh(std::cin);
        segment(mesh, std::strtoul(arguments[1], nullptr, 10), std::strtoul(arguments[2], nullptr, 10));
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return EXIT_FAILURE;
    }
}
