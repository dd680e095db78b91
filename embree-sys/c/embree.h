/* Input of bindgen: Embree's API, and the shim's functions in place of the headers' inline ones.
   Each `embree_sys_rtcX` is called `rtcX` in Rust. `build.rs` defines EMBREE_MAJOR. */
#pragma once
#if EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#if EMBREE_MAJOR == 3
void embree_sys_rtcInitIntersectContext(struct RTCIntersectContext *context);
#else
void embree_sys_rtcInitRayQueryContext(struct RTCRayQueryContext *context);
void embree_sys_rtcInitIntersectArguments(struct RTCIntersectArguments *args);
void embree_sys_rtcInitOccludedArguments(struct RTCOccludedArguments *args);
#endif
void embree_sys_rtcInitPointQueryContext(struct RTCPointQueryContext *context);
struct RTCBuildArguments embree_sys_rtcDefaultBuildArguments(void);

void embree_sys_rtcInterpolate0(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P,
                                unsigned int valueCount);
void embree_sys_rtcInterpolate1(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P, float *dPdu,
                                float *dPdv, unsigned int valueCount);
void embree_sys_rtcInterpolate2(RTCGeometry geometry, unsigned int primID, float u, float v,
                                enum RTCBufferType bufferType, unsigned int bufferSlot, float *P, float *dPdu,
                                float *dPdv, float *ddPdudu, float *ddPdvdv, float *ddPdudv,
                                unsigned int valueCount);

void embree_sys_rtcInitQuaternionDecomposition(struct RTCQuaternionDecomposition *qdecomp);
void embree_sys_rtcQuaternionDecompositionSetQuaternion(struct RTCQuaternionDecomposition *qdecomp, float r,
                                                        float i, float j, float k);
void embree_sys_rtcQuaternionDecompositionSetScale(struct RTCQuaternionDecomposition *qdecomp, float scale_x,
                                                   float scale_y, float scale_z);
void embree_sys_rtcQuaternionDecompositionSetSkew(struct RTCQuaternionDecomposition *qdecomp, float skew_xy,
                                                  float skew_xz, float skew_yz);
void embree_sys_rtcQuaternionDecompositionSetShift(struct RTCQuaternionDecomposition *qdecomp, float shift_x,
                                                   float shift_y, float shift_z);
void embree_sys_rtcQuaternionDecompositionSetTranslation(struct RTCQuaternionDecomposition *qdecomp,
                                                         float translation_x, float translation_y,
                                                         float translation_z);

/* Inline in C++ only: ray `i` of a packet of `N`, in and out. */
struct RTCRay embree_sys_rtcGetRayFromRayN(struct RTCRayN *rayN, unsigned int N, unsigned int i);
struct RTCHit embree_sys_rtcGetHitFromHitN(struct RTCHitN *hitN, unsigned int N, unsigned int i);
struct RTCRayHit embree_sys_rtcGetRayHitFromRayHitN(struct RTCRayHitN *rayhitN, unsigned int N, unsigned int i);
void embree_sys_rtcCopyHitToHitN(struct RTCHitN *hitN, const struct RTCHit *hit, unsigned int N, unsigned int i);

/* Sizes, alignments and offsets as the C compiler sees them, for the layout test. */
struct embree_sys_layout {
  const char *name;
  size_t value;
};
/* Returns the table and writes its length. */
const struct embree_sys_layout *embree_sys_layouts(size_t *count);
