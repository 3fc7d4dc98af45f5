#ifndef KINO_VIZ_UI_SHARED_H
#define KINO_VIZ_UI_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct UiParams {
    vec2 scale;  // clip space from pixels of the picture
    vec2 offset;
};

KINO_SHARED_END

#endif
