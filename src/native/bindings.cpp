// The only file that knows Python: numpy arrays in, views out. Shapes are checked by src/nofacet/model.py's contract.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "bezier/bernstein.h"
#include "methods.h"

namespace nb = nanobind;
using namespace nofacet;

namespace {

template <class T, class... Shape>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
template <class T>
using Buffer = std::optional<nb::ndarray<T, nb::c_contig, nb::device::cpu>>;

// The prepared scene and the Python arrays it looks into.
struct BoundScene {
  std::vector<nb::object> kept;
  std::unique_ptr<Scene> scene;
};

template <class T, class... Shape>
const T* field(BoundScene& bound, nb::handle owner, const char* name, std::size_t* count = nullptr) {
  nb::object object = owner.attr(name);
  const auto array = nb::cast<Array<T, Shape...>>(object);
  bound.kept.push_back(object);
  if (count) *count = array.shape(0);
  return array.data();
}

PatchGroup patch_group(BoundScene& bound, nb::handle source) {
  PatchGroup group;
  group.control_points = field<double, nb::shape<-1, -1, -1, 4>>(bound, source, "control_points", &group.count);
  const auto points = nb::cast<Array<double>>(source.attr("control_points"));
  group.degree_u = int(points.shape(1)) - 1;
  group.degree_v = int(points.shape(2)) - 1;
  if (group.degree_u < 1 || group.degree_v < 1 || group.degree_u > kMaxDegree || group.degree_v > kMaxDegree) {
    throw std::invalid_argument("patch degrees must be between 1 and " + std::to_string(kMaxDegree));
  }
  group.definition = field<int32_t, nb::shape<-1>>(bound, source, "definition");
  group.domain = field<double, nb::shape<-1, 4>>(bound, source, "domain");
  group.angular = field<uint8_t, nb::shape<-1, 2>>(bound, source, "angular");
  return group;
}

void init_scene(BoundScene* self, nb::handle source) {
  new (self) BoundScene();
  Model model;
  for (nb::handle group : source.attr("groups")) model.groups.push_back(patch_group(*self, group));
  model.trimmed = field<uint8_t, nb::shape<-1>>(*self, source, "trimmed", &model.definition_count);
  model.definition_loops = field<int64_t, nb::shape<-1>>(*self, source, "definition_loops");
  model.loop_offsets = field<int64_t, nb::shape<-1>>(*self, source, "loop_offsets");
  model.segment_offsets = field<int64_t, nb::shape<-1>>(*self, source, "segment_offsets");
  model.segment_points = field<double, nb::shape<-1, 3>>(*self, source, "segment_points");
  model.segment_edge = field<int32_t, nb::shape<-1>>(*self, source, "segment_edge");
  model.face_definition = field<int32_t, nb::shape<-1>>(*self, source, "face_definition", &model.face_count);
  model.face_placement = field<int32_t, nb::shape<-1>>(*self, source, "face_placement");
  model.placements = field<double, nb::shape<-1, 4, 4>>(*self, source, "placements");
  model.face_color = field<float, nb::shape<-1, 4>>(*self, source, "face_color");
  self->scene = std::make_unique<Scene>(std::move(model));
}

template <class T>
T* data_or_null(Buffer<T>& buffer) {
  return buffer ? buffer->data() : nullptr;
}

nb::dict render(const BoundScene& bound, const std::string& method_name, std::tuple<double, double, double> eye,
                Array<double, nb::shape<3, 3>> axes, double scale, bool perspective, int width, int height, int samples,
                int threads, bool edges, bool shadows, double reflectance, Buffer<float> color, Buffer<float> coverage,
                Buffer<double> depth, Buffer<int32_t> face, Buffer<double> uv, Buffer<float> normal) {
  const Method* method = find_method(method_name);
  if (!method) throw std::invalid_argument("unknown method " + method_name);
  Camera camera{};
  std::tie(camera.eye[0], camera.eye[1], camera.eye[2]) = eye;
  for (int c = 0; c < 3; ++c) {
    camera.right[c] = axes.data()[c];
    camera.up[c] = axes.data()[3 + c];
    camera.forward[c] = axes.data()[6 + c];
  }
  camera.scale = scale;
  camera.perspective = perspective;
  camera.width = width;
  camera.height = height;
  const Frame frame{width,
                    height,
                    data_or_null(color),
                    data_or_null(coverage),
                    data_or_null(depth),
                    data_or_null(face),
                    data_or_null(uv),
                    data_or_null(normal)};
  RenderStats stats;
  {
    nb::gil_scoped_release release;
    stats = method->render(*bound.scene, camera, {samples, threads, edges, shadows, reflectance}, frame);
  }
  nb::dict result;
  result["subdivide_seconds"] = stats.subdivide_seconds;
  result["scan_seconds"] = stats.scan_seconds;
  result["edge_seconds"] = stats.edge_seconds;
  result["pieces"] = stats.pieces;
  result["unresolved"] = stats.unresolved;
  result["unresolved_faces"] = stats.unresolved_faces;
  return result;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  return names;
}

bool casts_secondary_rays(const std::string& name) {
  const Method* method = find_method(name);
  return method && method->secondary_rays;
}

}  // namespace

NB_MODULE(_native, module) {
  module.doc() = "nofacet's native renderer: patches and trim loops in, pixel buffers out.";
  nb::class_<BoundScene>(module, "Scene", "A model prepared for drawing; looks into the model's arrays.")
      .def("__init__", &init_scene, nb::arg("model"))
      .def("render", &render, nb::arg("method"), nb::arg("eye"), nb::arg("axes"), nb::arg("scale"),
           nb::arg("perspective"), nb::arg("width"), nb::arg("height"), nb::arg("samples"), nb::arg("threads"),
           nb::arg("edges"), nb::arg("shadows"), nb::arg("reflectance"), nb::arg("color") = nb::none(),
           nb::arg("coverage") = nb::none(), nb::arg("depth") = nb::none(), nb::arg("face") = nb::none(),
           nb::arg("uv") = nb::none(), nb::arg("normal") = nb::none(),
           "Fill the given buffers (see CONTRACT: shapes (height, width[, channels])); returns the stage statistics.");
  module.def("method_names", &method_names, "Names of the rendering methods.");
  module.def("casts_secondary_rays", &casts_secondary_rays, nb::arg("method"),
             "Whether the method offers shadows and mirror reflection.");
}
