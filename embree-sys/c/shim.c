/* Embree's inline functions as functions that Rust can call, and the layout of its structures. */
#include "embree.h"
#include <string.h>

#if EMBREE_MAJOR == 3
void embree_sys_rtcInitIntersectContext(struct RTCIntersectContext *context) { rtcInitIntersectContext(context); }
#else
void embree_sys_rtcInitRayQueryContext(struct RTCRayQueryContext *context) { rtcInitRayQueryContext(context); }

void embree_sys_rtcInitIntersectArguments(struct RTCIntersectArguments *args) { rtcInitIntersectArguments(args); }

void embree_sys_rtcInitOccludedArguments(struct RTCOccludedArguments *args) { rtcInitOccludedArguments(args); }
#endif

void embree_sys_rtcInitPointQueryContext(struct RTCPointQueryContext *context) {
  rtcInitPointQueryContext(context);
}

struct RTCBuildArguments embree_sys_rtcDefaultBuildArguments(void) { return rtcDefaultBuildArguments(); }

void embree_sys_rtcInterpolate0(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P,
                                unsigned int valueCount) {
  rtcInterpolate0(geometry, primID, u, v, bufferType, bufferSlot, P, valueCount);
}

void embree_sys_rtcInterpolate1(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P, float *dPdu,
                                float *dPdv, unsigned int valueCount) {
  rtcInterpolate1(geometry, primID, u, v, bufferType, bufferSlot, P, dPdu, dPdv, valueCount);
}

void embree_sys_rtcInterpolate2(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P, float *dPdu,
                                float *dPdv, float *ddPdudu, float *ddPdvdv, float *ddPdudv,
                                unsigned int valueCount) {
  rtcInterpolate2(geometry, primID, u, v, bufferType, bufferSlot, P, dPdu, dPdv, ddPdudu, ddPdvdv, ddPdudv,
                  valueCount);
}

void embree_sys_rtcInitQuaternionDecomposition(struct RTCQuaternionDecomposition *qdecomp) {
  rtcInitQuaternionDecomposition(qdecomp);
}

void embree_sys_rtcQuaternionDecompositionSetQuaternion(struct RTCQuaternionDecomposition *qdecomp, float r,
                                                        float i, float j, float k) {
  rtcQuaternionDecompositionSetQuaternion(qdecomp, r, i, j, k);
}

void embree_sys_rtcQuaternionDecompositionSetScale(struct RTCQuaternionDecomposition *qdecomp, float scale_x,
                                                   float scale_y, float scale_z) {
  rtcQuaternionDecompositionSetScale(qdecomp, scale_x, scale_y, scale_z);
}

void embree_sys_rtcQuaternionDecompositionSetSkew(struct RTCQuaternionDecomposition *qdecomp, float skew_xy,
                                                  float skew_xz, float skew_yz) {
  rtcQuaternionDecompositionSetSkew(qdecomp, skew_xy, skew_xz, skew_yz);
}

void embree_sys_rtcQuaternionDecompositionSetShift(struct RTCQuaternionDecomposition *qdecomp, float shift_x,
                                                   float shift_y, float shift_z) {
  rtcQuaternionDecompositionSetShift(qdecomp, shift_x, shift_y, shift_z);
}

void embree_sys_rtcQuaternionDecompositionSetTranslation(struct RTCQuaternionDecomposition *qdecomp,
                                                         float translation_x, float translation_y,
                                                         float translation_z) {
  rtcQuaternionDecompositionSetTranslation(qdecomp, translation_x, translation_y, translation_z);
}

/* A packet of N is an array of 4-byte words, N per member in the order of the single structure: so member m
   of ray i is word m*N+i (members of RTCRay: 12, of RTCHit: 7 and the instance stack, of which some releases of
   Embree 4 have a second one, for the instances of arrays). */
#ifdef RTC_GEOMETRY_INSTANCE_ARRAY
#define INSTANCE_STACKS 2
#else
#define INSTANCE_STACKS 1
#endif
#define RAY_WORDS (sizeof(struct RTCRay) / 4)
#define HIT_WORDS (offsetof(struct RTCHit, instID) / 4 + INSTANCE_STACKS * RTC_MAX_INSTANCE_LEVEL_COUNT)

static void gather(void *one, const void *packet, size_t words, size_t N, size_t i) {
  for (size_t m = 0; m < words; ++m)
    memcpy((char *)one + 4 * m, (const char *)packet + 4 * (m * N + i), 4);
}

static void scatter(void *packet, const void *one, size_t words, size_t N, size_t i) {
  for (size_t m = 0; m < words; ++m)
    memcpy((char *)packet + 4 * (m * N + i), (const char *)one + 4 * m, 4);
}

struct RTCRay embree_sys_rtcGetRayFromRayN(struct RTCRayN *rayN, unsigned int N, unsigned int i) {
  struct RTCRay ray;
  gather(&ray, rayN, RAY_WORDS, N, i);
  return ray;
}

struct RTCHit embree_sys_rtcGetHitFromHitN(struct RTCHitN *hitN, unsigned int N, unsigned int i) {
  struct RTCHit hit;
  gather(&hit, hitN, HIT_WORDS, N, i);
  return hit;
}

struct RTCRayHit embree_sys_rtcGetRayHitFromRayHitN(struct RTCRayHitN *rayhitN, unsigned int N, unsigned int i) {
  struct RTCRayHit rayhit;
  gather(&rayhit.ray, rayhitN, RAY_WORDS, N, i);
  gather(&rayhit.hit, (char *)rayhitN + 4 * RAY_WORDS * N, HIT_WORDS, N, i);
  return rayhit;
}

void embree_sys_rtcCopyHitToHitN(struct RTCHitN *hitN, const struct RTCHit *hit, unsigned int N, unsigned int i) {
  scatter(hitN, hit, HIT_WORDS, N, i);
}

#define ALIGNOF(T) offsetof(struct { char before; struct T it; }, it)
#define TYPE(T) {#T, sizeof(struct T)}, {#T " align", ALIGNOF(T)},
#define FIELD(T, F) {#T "." #F, offsetof(struct T, F)},

static const struct embree_sys_layout layouts[] = {
#include "layout.inc"
};

const struct embree_sys_layout *embree_sys_layouts(size_t *count) {
  *count = sizeof(layouts) / sizeof(layouts[0]);
  return layouts;
}
