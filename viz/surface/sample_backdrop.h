#ifndef KINO_VIZ_SURFACE_SAMPLE_BACKDROP_H
#define KINO_VIZ_SURFACE_SAMPLE_BACKDROP_H

// What stands, negated, for the colour of samples that show the background where it is not stored:
// beyond all colours of 24 bits.
#define KINO_BACKDROP_COLOR 33554432.0f
#endif
