#include "apps/sources.h"

#include "skeleton/synthetic/synthetic_source.h"

namespace kino {

void register_sources() {
    register_synthetic_source();
}

}  // namespace kino
