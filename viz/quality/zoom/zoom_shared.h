#ifndef KINO_VIZ_QUALITY_ZOOM_ZOOM_SHARED_H
#define KINO_VIZ_QUALITY_ZOOM_ZOOM_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct ZoomParams {
    ivec2 offset;  // of the picture within the enlarged one, px
    int z;
};

KINO_SHARED_END
#endif
