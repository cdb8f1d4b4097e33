// The only file that knows Python: numpy arrays in, views out. Shapes are checked by src/nofacet/model.py's contract.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "bezier/bernstein.h"
#include "buffer_pool.h"
#include "extent.h"
#include "extract/cuts.h"
#include "extract/distinct.h"
#include "extract/expand.h"
#include "extract/segment_table.h"
#include "extract/spline.h"
#include "extract/stream_scan.h"
#include "extract/trim_loops.h"
#include "extract/use_order.h"
#include "floor.h"
#include "light.h"
#include "methods.h"
#include "outline.h"
#include "srgb.h"
#include "surface_point.h"

namespace nb = nanobind;
using namespace nofacet;

namespace {

template <class T, class... Shape>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
template <class T>
using Buffer = std::optional<nb::ndarray<T, nb::c_contig, nb::device::cpu>>;

// Python arrays that C++ looks into; copies of them where they had the wrong type or layout.
using Kept = std::vector<nb::ndarray<>>;

// The prepared scene and the arrays it looks into.
struct BoundScene {
  Kept kept;
  std::unique_ptr<Scene> scene;
};

template <class T, class... Shape>
const T* field(Kept& kept, nb::handle owner, const char* name, std::size_t* count = nullptr) {
  const auto array = nb::cast<Array<T, Shape...>>(owner.attr(name));
  kept.emplace_back(array);
  if (count) *count = array.shape(0);
  return array.data();
}

PatchGroup patch_group(Kept& kept, nb::handle source) {
  PatchGroup group;
  group.control_points = field<double, nb::shape<-1, -1, -1, 4>>(kept, source, "control_points", &group.count);
  const auto points = nb::cast<Array<double>>(source.attr("control_points"));
  group.degree_u = int(points.shape(1)) - 1;
  group.degree_v = int(points.shape(2)) - 1;
  if (group.degree_u < 1 || group.degree_v < 1 || group.degree_u > kMaxDegree || group.degree_v > kMaxDegree) {
    throw std::invalid_argument("patch degrees must be between 1 and " + std::to_string(kMaxDegree));
  }
  group.definition = field<int32_t, nb::shape<-1>>(kept, source, "definition");
  group.domain = field<double, nb::shape<-1, 4>>(kept, source, "domain");
  group.angular = field<uint8_t, nb::shape<-1, 2>>(kept, source, "angular");
  return group;
}

Model model_view(Kept& kept, nb::handle source) {
  Model model;
  for (nb::handle group : source.attr("groups")) model.groups.push_back(patch_group(kept, group));
  model.trimmed = field<uint8_t, nb::shape<-1>>(kept, source, "trimmed", &model.definition_count);
  model.definition_loops = field<int64_t, nb::shape<-1>>(kept, source, "definition_loops");
  model.loop_offsets = field<int64_t, nb::shape<-1>>(kept, source, "loop_offsets");
  model.segment_offsets = field<int64_t, nb::shape<-1>>(kept, source, "segment_offsets");
  model.segment_points = field<double, nb::shape<-1, 3>>(kept, source, "segment_points");
  model.segment_edge = field<int32_t, nb::shape<-1>>(kept, source, "segment_edge");
  model.face_definition = field<int32_t, nb::shape<-1>>(kept, source, "face_definition", &model.face_count);
  model.face_placement = field<int32_t, nb::shape<-1>>(kept, source, "face_placement");
  model.placements = field<double, nb::shape<-1, 4, 4>>(kept, source, "placements");
  model.face_outward = field<int8_t, nb::shape<-1>>(kept, source, "face_outward");
  model.face_color = field<float, nb::shape<-1, 4>>(kept, source, "face_color");
  model.body_closed = field<uint8_t, nb::shape<-1>>(kept, source, "body_closed", &model.body_count);
  model.body_offsets = field<int64_t, nb::shape<-1>>(kept, source, "body_offsets");
  model.body_face = field<int32_t, nb::shape<-1>>(kept, source, "body_face");
  model.body_face_outward = field<int8_t, nb::shape<-1>>(kept, source, "body_face_outward");
  return model;
}

void init_scene(BoundScene* self, nb::handle source) {
  new (self) BoundScene();
  Model model = model_view(self->kept, source);
  nb::gil_scoped_release release;
  self->scene = std::make_unique<Scene>(std::move(model));
}

// Set by one thread, read by those that work.
struct Cancel {
  std::atomic<bool> set{false};
};

// A numpy array that owns a vector.
template <class T, class Shape>
auto owned(std::vector<T>&& values, Shape shape) {
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T>(kept->data(), shape.size(), shape.begin(), owner);
}
template <class T>
auto owned(std::vector<T>&& values) {
  const std::size_t count = values.size();
  return owned(std::move(values), std::initializer_list<std::size_t>{count});
}

auto owned_pairs(std::vector<double>&& pairs) {
  const std::size_t count = pairs.size() / 2;
  return owned(std::move(pairs), std::initializer_list<std::size_t>{count, 2});
}

// A numpy array of bool.
auto owned_flags(std::vector<uint8_t>&& values) {
  return nb::object(nb::cast(owned(std::move(values))).attr("view")("?"));
}

nb::tuple surface_points_of(nb::handle source) {
  Kept kept;
  const Model model = model_view(kept, source);
  SurfacePoints points;
  {
    nb::gil_scoped_release release;
    points = surface_points(model);
  }
  const std::size_t count = points.xyz.size() / 3;
  return nb::make_tuple(owned(std::move(points.xyz), std::initializer_list<std::size_t>{count, 3}),
                        owned(std::vector<int64_t>(points.first.begin(), points.first.end())));
}

auto support_of(nb::handle source, Array<double, nb::shape<-1, 3>> directions) {
  Kept kept;
  const Model model = model_view(kept, source);
  std::vector<double> reach;
  {
    nb::gil_scoped_release release;
    reach = support(model, surface_points(model), directions.data(), directions.shape(0));
  }
  return owned(std::move(reach));
}

template <class T>
T* data_or_null(Buffer<T>& buffer) {
  return buffer ? buffer->data() : nullptr;
}

Camera make_camera(std::tuple<double, double, double> eye, Array<double, nb::shape<3, 3>> axes, double scale,
                   bool perspective, int width, int height) {
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
  return camera;
}

nb::dict render(const BoundScene& bound, const std::string& method_name, std::tuple<double, double, double> eye,
                Array<double, nb::shape<3, 3>> axes, double scale, bool perspective, int width, int height, int samples,
                int threads, bool edges, bool shadows, double reflectance, Array<double, nb::shape<-1, 2, 3>> sections,
                const Cancel* cancel, Buffer<float> color, Buffer<float> coverage, Buffer<double> depth,
                Buffer<int32_t> face, Buffer<double> uv, Buffer<float> normal) {
  const Method* method = find_method(method_name);
  if (!method) throw std::invalid_argument("unknown method " + method_name);
  const Camera camera = make_camera(eye, axes, scale, perspective, width, height);
  const Frame frame{width,
                    height,
                    data_or_null(color),
                    data_or_null(coverage),
                    data_or_null(depth),
                    data_or_null(face),
                    data_or_null(uv),
                    data_or_null(normal)};
  RenderOptions options{samples, threads, edges, shadows, reflectance, {}, cancel ? &cancel->set : nullptr};
  for (std::size_t k = 0; k < sections.shape(0); ++k) {
    SectionPlane& plane = options.sections.emplace_back();
    std::copy_n(sections.data() + 6 * k, 3, plane.origin);
    std::copy_n(sections.data() + 6 * k + 3, 3, plane.normal);
  }
  RenderStats stats;
  {
    nb::gil_scoped_release release;
    stats = method->render(*bound.scene, camera, options, frame);
  }
  nb::dict result;
  result["cancelled"] = options.cancelled();
  result["project_seconds"] = stats.project_seconds;
  result["subdivide_seconds"] = stats.subdivide_seconds;
  result["span_seconds"] = stats.span_seconds;
  result["visibility_seconds"] = stats.visibility_seconds;
  result["shade_seconds"] = stats.shade_seconds;
  result["average_seconds"] = stats.average_seconds;
  result["trace_seconds"] = stats.trace_seconds;
  result["edge_seconds"] = stats.edge_seconds;
  result["pieces"] = stats.pieces;
  result["unresolved"] = stats.unresolved;
  result["unresolved_faces"] = stats.unresolved_faces;
  if (options.sections.empty()) return result;
  result["uncapped_faces"] = stats.uncapped_faces;
  result["section_gaps"] = stats.section_gaps;
  return result;
}

// Uninitialised memory for a frame's buffer, from the pool and back to it when the last array on it is gone.
nb::ndarray<nb::numpy, uint8_t, nb::ndim<1>> frame_buffer(std::size_t bytes) {
  struct Lease {
    void* memory;
    std::size_t bytes;
  };
  auto* lease = new Lease{BufferPool::instance().take(bytes), bytes};
  nb::capsule owner(lease, [](void* p) noexcept {
    auto* held = static_cast<Lease*>(p);
    BufferPool::instance().give_back(held->memory, held->bytes);
    delete held;
  });
  return {lease->memory, {bytes}, owner};
}

void srgb8_into(Array<float, nb::shape<-1, -1, 4>> color, std::optional<Array<double, nb::shape<3>>> background,
                int threads, nb::ndarray<uint8_t, nb::shape<-1, -1, 4>, nb::c_contig, nb::device::cpu> out) {
  if (out.size() != color.size()) throw std::invalid_argument("pictures of different sizes");
  nb::gil_scoped_release release;
  srgb8(color.data(), color.size() / 4, background ? background->data() : nullptr, threads, out.data());
}

nb::dict measure_scene_floor(const BoundScene& bound, Array<int32_t, nb::shape<-1, -1>> face,
                             Array<double, nb::shape<-1, -1, 2>> uv, int repeats) {
  FloorResult floor;
  {
    nb::gil_scoped_release release;
    floor = measure_floor(*bound.scene, face.data(), uv.data(), face.size(), repeats);
  }
  nb::dict result;
  result["seconds"] = floor.seconds;
  result["samples"] = floor.samples;
  result["checksum"] = floor.checksum;
  return result;
}

using Rows = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

void evaluate_scene(const BoundScene& bound, Array<int32_t, nb::shape<-1>> face, Array<double, nb::shape<-1, 2>> uv,
                    Rows position, Rows normal, Rows curvature, Rows direction) {
  const std::size_t n = face.size();
  if (uv.shape(0) != n || position.size() != 3 * n || normal.size() != 3 * n || curvature.size() != 2 * n ||
      direction.size() != 6 * n) {
    throw std::invalid_argument("arrays of different lengths");
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (face.data()[k] >= int64_t(bound.scene->model.face_count)) throw std::invalid_argument("no such face");
  }
  nb::gil_scoped_release release;
  evaluate_surface(*bound.scene, face.data(), uv.data(), n,
                   {position.data(), normal.data(), curvature.data(), direction.data()});
}

nb::tuple scene_outline(const BoundScene& bound, std::tuple<double, double, double> eye,
                        Array<double, nb::shape<3, 3>> axes, double scale, bool perspective, int width, int height) {
  Outline found;
  {
    nb::gil_scoped_release release;
    found = outline(*bound.scene, make_camera(eye, axes, scale, perspective, width, height));
  }
  return nb::make_tuple(owned(std::move(found.offsets)), owned_pairs(std::move(found.ends)));
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  return names;
}

using Column = Array<double, nb::shape<-1>>;

Bytes bytes_of(const nb::bytes& data) { return {static_cast<const unsigned char*>(data.data()), data.size()}; }

// All columns of a table must be as long as the first.
template <class... Arrays>
void check_lengths(std::size_t count, const Arrays&... arrays) {
  if (((arrays.shape(0) != count) || ...)) throw std::invalid_argument("columns of different lengths");
}

auto owned_points(std::vector<double>&& points, std::size_t count, int degree, std::size_t components) {
  return owned(std::move(points), std::initializer_list<std::size_t>{count, std::size_t(degree + 1), components});
}

nb::tuple curve_pieces_of(int degree, Array<double, nb::shape<-1, -1>> poles, Column knots,
                          Array<int32_t, nb::shape<-1>> multiplicities, bool periodic, double low, double high) {
  check_lengths(knots.size(), multiplicities);
  const KnotVector vector(degree, periodic, std::vector<double>(knots.data(), knots.data() + knots.size()),
                          std::vector<int>(multiplicities.data(), multiplicities.data() + multiplicities.size()), low,
                          high);
  if (poles.shape(0) < vector.pole_count()) throw std::invalid_argument("a spline has too few poles");
  CurvePieces pieces = curve_pieces(vector, poles.data(), poles.shape(1), low, high);
  const std::size_t count = pieces.start.size();
  return nb::make_tuple(owned(std::move(pieces.start)), owned(std::move(pieces.stop)),
                        owned_points(std::move(pieces.points), count, degree, poles.shape(1)));
}

nb::list spline_pieces_of(const nb::bytes& data, int dim, Array<int64_t, nb::shape<-1>> at, Column first, Column last) {
  check_lengths(at.size(), first, last);
  nb::list result;
  for (CurvePieces& part : spline_pieces(bytes_of(data), dim, at.size(), at.data(), first.data(), last.data())) {
    const std::size_t count = part.owner.size();
    result.append(nb::make_tuple(owned(std::move(part.owner)), owned(std::move(part.start)),
                                 owned(std::move(part.stop)),
                                 owned_points(std::move(part.points), count, part.degree, std::size_t(dim + 1))));
  }
  return result;
}

nb::list spline_patches_of(const nb::bytes& data, bool bezier, Array<int64_t, nb::shape<-1>> at,
                           Array<double, nb::shape<-1, 4>> boxes) {
  check_lengths(at.size(), boxes);
  nb::list result;
  for (SurfacePatches& part : spline_patches(bytes_of(data), bezier, at.size(), at.data(), boxes.data())) {
    const std::size_t count = part.owner.size();
    const std::initializer_list<std::size_t> shape{count, std::size_t(part.degree_u + 1),
                                                   std::size_t(part.degree_v + 1), 4};
    result.append(nb::make_tuple(owned(std::move(part.owner)),
                                 owned(std::move(part.domain), std::initializer_list<std::size_t>{count, 4}),
                                 owned(std::move(part.points), shape)));
  }
  return result;
}

nb::tuple columns(CurveScan&& scan) {
  return nb::make_tuple(owned(std::move(scan.start)), owned(std::move(scan.kind)), owned(std::move(scan.at)));
}

nb::tuple scan_curves_of(const nb::bytes& data, std::size_t at, int dim, std::size_t count) {
  CurveScan scan = scan_curves(bytes_of(data), dim, count, &at);
  return nb::make_tuple(owned(std::move(scan.start)), owned(std::move(scan.kind)), owned(std::move(scan.at)), at);
}

nb::tuple scan_surfaces_of(const nb::bytes& data, std::size_t at, std::size_t count) {
  SurfaceScan scan = scan_surfaces(bytes_of(data), count, &at);
  return nb::make_tuple(
      nb::make_tuple(owned(std::move(scan.start)), owned(std::move(scan.kind)), owned(std::move(scan.at))),
      columns(std::move(scan.profiles)), owned(std::move(scan.profile)), at);
}

nb::tuple scan_shapes_of(const nb::bytes& data, std::size_t at, std::size_t count) {
  ShapeScan s = scan_shapes(bytes_of(data), count, &at);
  return nb::make_tuple(owned(std::move(s.kinds)),
                        nb::make_tuple(owned(std::move(s.child_offsets)), owned(std::move(s.child_orientation)),
                                       owned(std::move(s.child_shape)), owned(std::move(s.child_location))),
                        nb::make_tuple(owned(std::move(s.face_surface)), owned(std::move(s.face_location)),
                                       owned(std::move(s.face_triangulation))),
                        nb::make_tuple(owned(std::move(s.edge_tolerance)), owned_flags(std::move(s.edge_degenerated)),
                                       owned(std::move(s.edge_curve)), owned(std::move(s.edge_location)),
                                       owned(std::move(s.edge_first)), owned(std::move(s.edge_last))),
                        nb::make_tuple(owned(std::move(s.pcurve_offsets)), owned(std::move(s.pcurve_curve)),
                                       owned(std::move(s.pcurve_second)), owned(std::move(s.pcurve_surface)),
                                       owned(std::move(s.pcurve_location)), owned(std::move(s.pcurve_first)),
                                       owned(std::move(s.pcurve_last))),
                        at);
}

using Indices = Array<int64_t, nb::shape<-1>>;
using Flags = Array<bool, nb::shape<-1>>;
using Pairs = Array<double, nb::shape<-1, 2>>;
using BoxRows = Array<double, nb::shape<-1, 4>>;

nb::tuple distinct_of(Indices keys) {
  Distinct found = distinct(keys.data(), keys.size());
  return nb::make_tuple(owned(std::move(found.first)), owned(std::move(found.number)));
}

nb::tuple expand_of(Indices start, Indices count) {
  check_lengths(start.size(), count);
  Expanded rows = expand(start.data(), count.data(), start.size());
  return nb::make_tuple(owned(std::move(rows.owner)), owned(std::move(rows.number)));
}

nb::tuple cut_evenly_of(Column low, Column high, double limit) {
  check_lengths(low.size(), high);
  Cuts cuts = cut_evenly(low.size(), low.data(), high.data(), limit);
  return nb::make_tuple(owned(std::move(cuts.owner)), owned(std::move(cuts.start)), owned(std::move(cuts.stop)));
}

nb::tuple segment_table_of(nb::list parts, std::size_t uses) {
  Kept kept;
  std::vector<PieceView> views;
  for (nb::handle part : parts) {
    PieceView view{};
    view.owner = field<int64_t, nb::shape<-1>>(kept, part, "owner", &view.count);
    view.points = field<double, nb::shape<-1, -1, 3>>(kept, part, "points");
    check_lengths(view.count, kept.back());
    view.degree = int(kept.back().shape(1)) - 1;
    views.push_back(view);
    for (std::size_t k = 0; k < view.count; ++k) {
      if (view.owner[k] < 0 || std::size_t(view.owner[k]) >= uses) throw std::invalid_argument("no such use");
    }
  }
  SegmentTable table = segment_table(views, uses);
  const std::size_t count = table.points.size() / 3;
  return nb::make_tuple(owned(std::move(table.offsets)), owned(std::move(table.first_point)),
                        owned(std::move(table.degree)),
                        owned(std::move(table.points), std::initializer_list<std::size_t>{count, 3}));
}

nb::tuple order_uses_of(Indices wire, Pairs start, Pairs end, Pairs size) {
  check_lengths(wire.size(), start, end, size);
  UseOrder order = order_uses({wire.size(), wire.data(), start.data(), end.data(), size.data()});
  return nb::make_tuple(owned(std::move(order.use)), owned(std::move(order.loop)), owned(std::move(order.unclear)));
}

SegmentView segment_view(Kept& kept, nb::handle segments) {
  return {field<int64_t, nb::shape<-1>>(kept, segments, "first_point"),
          field<int64_t, nb::shape<-1>>(kept, segments, "degree"),
          field<double, nb::shape<-1, 3>>(kept, segments, "points")};
}

nb::tuple use_ends_of(Indices wire, Flags reversed, nb::handle segments) {
  Kept kept;
  check_lengths(wire.size(), reversed);
  const auto* offsets = field<int64_t, nb::shape<-1>>(kept, segments, "offsets");
  UseEnds ends = use_ends(wire.size(), wire.data(), reversed.data(), offsets, segment_view(kept, segments));
  return nb::make_tuple(owned_pairs(std::move(ends.start)), owned_pairs(std::move(ends.end)),
                        owned_pairs(std::move(ends.size)));
}

RunView run_view(Kept& kept, nb::handle runs, nb::handle segments) {
  RunView view{};
  view.face = field<int64_t, nb::shape<-1>>(kept, runs, "face", &view.loops);
  view.loop_offsets = field<int64_t, nb::shape<-1>>(kept, runs, "loop_offsets");
  view.segment = field<int64_t, nb::shape<-1>>(kept, runs, "segment");
  view.backwards = field<bool, nb::shape<-1>>(kept, runs, "backwards");
  view.shift = field<double, nb::shape<-1, 2>>(kept, runs, "shift");
  view.edge = field<int64_t, nb::shape<-1>>(kept, runs, "edge");
  view.table = segment_view(kept, segments);
  return view;
}

auto owned_boxes(std::vector<double>&& boxes) {
  const std::size_t count = boxes.size() / 4;
  return owned(std::move(boxes), std::initializer_list<std::size_t>{count, 4});
}

auto bounding_boxes_of(nb::handle runs, nb::handle segments, std::size_t faces) {
  Kept kept;
  return owned_boxes(bounding_boxes(run_view(kept, runs, segments), faces));
}

auto corner_gaps_of(nb::handle runs, nb::handle segments, BoxRows boxes) {
  Kept kept;
  return owned(corner_gaps(run_view(kept, runs, segments), boxes.data()));
}

nb::tuple close_loops_of(nb::handle runs, nb::handle segments, BoxRows boxes, Flags kept_faces, Flags at_pole) {
  Kept kept;
  check_lengths(boxes.shape(0), kept_faces);
  std::vector<double> moved(boxes.data(), boxes.data() + boxes.size());
  LoopTable loops = close_loops(run_view(kept, runs, segments), kept_faces.data(), at_pole.data(), moved.data());
  const std::size_t count = loops.points.size() / 3;
  return nb::make_tuple(owned(std::move(loops.face)), owned(std::move(loops.loop_offsets)),
                        owned(std::move(loops.segment_offsets)),
                        owned(std::move(loops.points), std::initializer_list<std::size_t>{count, 3}),
                        owned(std::move(loops.edge)), owned_boxes(std::move(moved)));
}

nb::object rectangles_of(nb::handle loops, BoxRows boxes) {
  Kept kept;
  LoopView view{};
  view.face = field<int64_t, nb::shape<-1>>(kept, loops, "face", &view.loops);
  view.loop_offsets = field<int64_t, nb::shape<-1>>(kept, loops, "loop_offsets");
  view.segment_offsets = field<int64_t, nb::shape<-1>>(kept, loops, "segment_offsets");
  view.points = field<double, nb::shape<-1, 3>>(kept, loops, "points");
  return owned_flags(rectangles(view, boxes.data(), boxes.shape(0)));
}

nb::dict light_constants() {
  nb::dict light;
  light["direction"] = nb::make_tuple(kKeyLight[0], kKeyLight[1], kKeyLight[2]);
  light["ambient"] = kAmbient;
  light["sky"] = kSky;
  light["facing"] = kFacing;
  light["key"] = kKey;
  light["gloss"] = kGloss;
  light["gloss_exponent"] = kGlossExponent;
  return light;
}

bool casts_secondary_rays(const std::string& name) {
  const Method* method = find_method(name);
  return method && method->secondary_rays;
}

}  // namespace

NB_MODULE(_native, module) {
  module.doc() = "nofacet's native renderer: patches and trim loops in, pixel buffers out.";
  nb::class_<Cancel>(module, "Cancel",
                     "Stops renderings and readings that were given it, from another thread and for good.")
      .def(nb::init<>())
      .def(
          "set", [](Cancel& cancel) { cancel.set = true; }, "Ask whatever was given this object to stop.")
      .def("is_set", [](const Cancel& cancel) { return cancel.set.load(); }, "Whether set() was called.");
  nb::class_<BoundScene>(module, "Scene", "A model prepared for drawing; looks into the model's arrays.")
      .def("__init__", &init_scene, nb::arg("model"))
      .def("render", &render, nb::arg("method"), nb::arg("eye"), nb::arg("axes"), nb::arg("scale"),
           nb::arg("perspective"), nb::arg("width"), nb::arg("height"), nb::arg("samples"), nb::arg("threads"),
           nb::arg("edges"), nb::arg("shadows"), nb::arg("reflectance"), nb::arg("sections"), nb::arg("cancel").none(),
           nb::arg("color") = nb::none(), nb::arg("coverage") = nb::none(), nb::arg("depth") = nb::none(),
           nb::arg("face") = nb::none(), nb::arg("uv") = nb::none(), nb::arg("normal") = nb::none(),
           "Fill the given buffers (see CONTRACT: shapes (height, width[, channels])); returns the stage statistics.")
      .def("evaluate", &evaluate_scene, nb::arg("face"), nb::arg("uv"), nb::arg("position"), nb::arg("normal"),
           nb::arg("curvature"), nb::arg("direction"),
           "Fill the given arrays (see surface_point.h) for placed faces (n,) at OpenCascade's parameters (n, 2).")
      .def("floor", &measure_scene_floor, nb::arg("face"), nb::arg("uv"), nb::arg("repeats"),
           "Seconds that evaluating every shown sample takes where its (u, v) is known; from a frame's face and uv.")
      .def("outline", &scene_outline, nb::arg("eye"), nb::arg("axes"), nb::arg("scale"), nb::arg("perspective"),
           nb::arg("width"), nb::arg("height"),
           "Covered stretches of each pixel row, in pixels: offsets (height + 1,), ends (k, 2).");
  module.def("frame_buffer", &frame_buffer, nb::arg("bytes"),
             "Uninitialised uint8 array of shape (bytes,) in memory that is used again for later frames.");
  module.def(
      "release_frame_buffers", [] { BufferPool::instance().release(); }, "Frees the memory kept for later frames.");
  module.def("srgb8", &srgb8_into, nb::arg("color"), nb::arg("background").none(), nb::arg("threads"), nb::arg("out"),
             "Fill `out` (h, w, 4) with 8-bit sRGB of `color`, before a linear background or with straight alpha.");
  module.def("method_names", &method_names, "Names of the rendering methods.");
  module.def("casts_secondary_rays", &casts_secondary_rays, nb::arg("method"),
             "Whether the method offers shadows and mirror reflection.");
  module.def("light", &light_constants, "The light of every picture: the fields of nofacet.light.Light.");
  module.def("surface_points", &surface_points_of, nb::arg("model"),
             "Samples (N, 3) of the drawn surface, by definition, and where each definition's begin (D + 1,).");
  module.def("support", &support_of, nb::arg("model"), nb::arg("directions"),
             "How far the placed faces reach in world directions (n, 3): (n,).");
  module.def("curve_pieces", &curve_pieces_of, nb::arg("degree"), nb::arg("poles"), nb::arg("knots"),
             nb::arg("multiplicities"), nb::arg("periodic"), nb::arg("low"), nb::arg("high"),
             "Bezier pieces of a B-spline curve with poles (n, c): start, stop (m,), points (m, p + 1, c).");
  module.def("spline_pieces", &spline_pieces_of, nb::arg("data"), nb::arg("dim"), nb::arg("at"), nb::arg("first"),
             nb::arg("last"), "A stream's B-spline curves in pieces: the columns of CurvePieces for each degree.");
  module.def("spline_patches", &spline_patches_of, nb::arg("data"), nb::arg("bezier"), nb::arg("at"), nb::arg("boxes"),
             "A stream's B-spline or Bezier surfaces: the columns of SurfacePatches for each bidegree.");
  module.def("scan_curves", &scan_curves_of, nb::arg("data"), nb::arg("at"), nb::arg("dim"), nb::arg("count"),
             "The columns of CurveScan, and the byte behind the records.");
  module.def("scan_surfaces", &scan_surfaces_of, nb::arg("data"), nb::arg("at"), nb::arg("count"),
             "The columns of SurfaceScan: surfaces, profiles, profile of each; and the byte behind the records.");
  module.def("scan_shapes", &scan_shapes_of, nb::arg("data"), nb::arg("at"), nb::arg("count"),
             "The columns of ShapeScan: kinds, children, faces, edges, pcurves; and the byte behind the records.");
  module.def("distinct", &distinct_of, nb::arg("keys"),
             "Where each distinct key (n,) stands first, ascending; the place there of each key's own (n,).");
  module.def("expand", &expand_of, nb::arg("start"), nb::arg("count"),
             "The columns of Expanded: the numbers start[k] .. start[k] + count[k] - 1 for all k, and k.");
  module.def("cut_evenly", &cut_evenly_of, nb::arg("low"), nb::arg("high"), nb::arg("limit"),
             "Intervals in equal pieces: the columns of Cuts.");
  module.def("segment_table", &segment_table_of, nb::arg("parts"), nb::arg("uses"),
             "Pieces with owner (m,) and points (m, p + 1, 3) as one table: the columns of SegmentTable.");
  module.def("use_ends", &use_ends_of, nb::arg("wire"), nb::arg("reversed"), nb::arg("segments"),
             "Start, end of edge uses in (u, v), extent of their wires, each (U, 2).");
  module.def("order_uses", &order_uses_of, nb::arg("wire"), nb::arg("start"), nb::arg("end"), nb::arg("size"),
             "Edge uses in the order of their loops: use, loop, unclear wires.");
  module.def("bounding_boxes", &bounding_boxes_of, nb::arg("runs"), nb::arg("segments"), nb::arg("faces"),
             "u0, u1, v0, v1 (faces, 4) of loops.");
  module.def("corner_gaps", &corner_gaps_of, nb::arg("runs"), nb::arg("segments"), nb::arg("boxes"),
             "The entries of runs behind which there may be a corner.");
  module.def("close_loops", &close_loops_of, nb::arg("runs"), nb::arg("segments"), nb::arg("boxes"), nb::arg("kept"),
             nb::arg("at_pole"), "The columns of LoopTable, and the boxes brought up to date.");
  module.def("rectangles", &rectangles_of, nb::arg("loops"), nb::arg("boxes"),
             "Whether each face's loops are its box (faces,).");
}
