#include <nanobind/nanobind.h>

NB_MODULE(_native, module) { module.doc() = "nofacet's native renderer"; }
