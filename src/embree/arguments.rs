//! What a query takes beside scene and rays: in Embree 3 a context, before the rays; in Embree 4 arguments, one
//! kind for closest hits and one for any hit, after them. Nothing else of the queries differs, so all of them go
//! through here.

#![allow(unsafe_code)]

use embree_sys as sys;

/// Made once for many queries.
pub(super) struct Arguments {
    #[cfg(not(embree4))]
    context: sys::RTCIntersectContext,
    #[cfg(embree4)]
    closest: sys::RTCIntersectArguments,
    #[cfg(embree4)]
    any: sys::RTCOccludedArguments,
}

impl Arguments {
    /// For single rays, and packets whose rays go anywhere.
    pub fn new() -> Self {
        Self::of(false)
    }

    /// Says whether neighbouring rays go alike.
    #[cfg(not(embree4))]
    pub fn of(coherent: bool) -> Self {
        let mut context = sys::RTCIntersectContext::default();
        // SAFETY: writes the structure given.
        unsafe { sys::rtcInitIntersectContext(&mut context) };
        if coherent {
            context.flags = sys::RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        }
        Self { context }
    }

    /// Says whether neighbouring rays go alike.
    #[cfg(embree4)]
    pub fn of(coherent: bool) -> Self {
        let mut closest = sys::RTCIntersectArguments::default();
        let mut any = sys::RTCOccludedArguments::default();
        // SAFETY: writes the structures given.
        unsafe {
            sys::rtcInitIntersectArguments(&mut closest);
            sys::rtcInitOccludedArguments(&mut any);
        }
        if coherent {
            closest.flags = sys::RTC_RAY_QUERY_FLAG_COHERENT;
            any.flags = sys::RTC_RAY_QUERY_FLAG_COHERENT;
        }
        Self { closest, any }
    }

    /// The context, for what Embree 3 alone has.
    #[cfg(not(embree4))]
    pub fn context(&mut self) -> *mut sys::RTCIntersectContext {
        &mut self.context
    }
}

/// Two queries of `sys`, `$closest` and `$any`, called `$intersect` and `$occluded` here: for single rays or, with
/// a mask of the lanes that are on, for packets.
macro_rules! queries {
    ($intersect:ident = $closest:ident, $ray_hit:ident; $occluded:ident = $any:ident, $ray:ident; $($valid:ident)?) => {
        impl Arguments {
            /// Finds the closest hits.
            ///
            /// # Safety
            /// The scene is committed and live; the mask has a number for each lane and is aligned to all of them;
            /// rays that are on are valid.
            #[inline(always)]
            pub unsafe fn $intersect(
                &mut self,
                $($valid: *const i32,)?
                scene: sys::RTCScene,
                query: &mut sys::$ray_hit,
            ) {
                // SAFETY: the caller's promise; query and context are whole, aligned by their types and not shared.
                #[cfg(not(embree4))]
                unsafe { sys::$closest($($valid,)? scene, &mut self.context, query) };
                // SAFETY: the caller's promise; query and arguments are whole, aligned by their types and not shared.
                #[cfg(embree4)]
                unsafe { sys::$closest($($valid,)? scene, query, &mut self.closest) };
            }

            /// Finds out whether anything is hit.
            ///
            /// # Safety
            /// As for the closest hits.
            #[inline(always)]
            pub unsafe fn $occluded(
                &mut self,
                $($valid: *const i32,)?
                scene: sys::RTCScene,
                query: &mut sys::$ray,
            ) {
                // SAFETY: the caller's promise; query and context are whole, aligned by their types and not shared.
                #[cfg(not(embree4))]
                unsafe { sys::$any($($valid,)? scene, &mut self.context, query) };
                // SAFETY: the caller's promise; query and arguments are whole, aligned by their types and not shared.
                #[cfg(embree4)]
                unsafe { sys::$any($($valid,)? scene, query, &mut self.any) };
            }
        }
    };
}

queries!(intersect1 = rtcIntersect1, RTCRayHit; occluded1 = rtcOccluded1, RTCRay;);
queries!(intersect8 = rtcIntersect8, RTCRayHit8; occluded8 = rtcOccluded8, RTCRay8; lanes);
queries!(intersect16 = rtcIntersect16, RTCRayHit16; occluded16 = rtcOccluded16, RTCRay16; lanes);
