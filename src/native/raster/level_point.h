// Points at which a surface is level on the screen: y has no slope there, every way.
#pragma once
#include <optional>

#include "bezier/net.h"
#include "raster/scan_planes.h"

namespace nofacet {

// A part of a net's parameters.
struct ParameterBox {
  Interval a, b;
};

// A box inside the net's parameters, around a level point, where y most likely stays between two neighbouring scan
// planes: a good place to cut the net, for only outside of it are the planes' cuts graphs. Never all of the net;
// nothing if there is no such point, or none that is found.
std::optional<ParameterBox> find_level_box(const Net& net, const ScanPlanes& planes);

}  // namespace nofacet
