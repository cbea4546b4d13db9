// Included once per SIMD target, hence the guard that hwy/foreach_target.h toggles.
#if defined(OSTEOMILL_COMPRESS_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEOMILL_COMPRESS_LANES_INL
#undef OSTEOMILL_COMPRESS_LANES_INL
#else
#define OSTEOMILL_COMPRESS_LANES_INL
#endif

#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace osteomill {
namespace HWY_NAMESPACE {

/// Returns the mask as an integer: bit n is set if lane n is selected.
template <class D>
HWY_INLINE unsigned bits_of(D d, hwy::HWY_NAMESPACE::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hwy::HWY_NAMESPACE::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<unsigned>(bytes[1]) << 8;
}

/// Permutations for every selection of up to 8 lanes, indexed by bit mask: the selected lanes first, then the
/// others.
inline constexpr auto kLaneOrder = [] {
  constexpr int kLanes = 8;
  std::array<std::array<std::int32_t, kLanes>, 1u << kLanes> orders{};
  for (std::size_t bits = 0; bits < orders.size(); ++bits) {
    std::size_t n = 0;
    for (const std::size_t chosen : {std::size_t{1}, std::size_t{0}}) {
      for (int lane = 0; lane < kLanes; ++lane) {
        if ((bits >> lane & 1) == chosen) orders[bits][n++] = lane;
      }
    }
  }
  return orders;
}();

/// Moves the lanes selected by a mask to the front of a vector, in order; the remaining lanes are undefined.
/// One object serves any number of vectors. Highway's own Compress looks up its table for each vector, and
/// GCC 12 first copies that whole table to the stack: with AVX2, two thirds of the time of gathering points.
template <class D>
class CompressLanes {
 public:
  HWY_INLINE CompressLanes(D d, hwy::HWY_NAMESPACE::Mask<D> mask) : mask_(mask), bits_(bits_of(d, mask)) {}

  template <class V>
  HWY_INLINE V operator()(V v) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::DFromV<V> dv;
#if HWY_MAX_BYTES <= 32
    return hn::TableLookupLanes(v, hn::SetTableIndices(dv, kLaneOrder[bits_].data()));
#else
    return hn::Compress(v, hn::RebindMask(dv, mask_));
#endif
  }

 private:
  hwy::HWY_NAMESPACE::Mask<D> mask_;
  unsigned bits_;
};

}  // namespace HWY_NAMESPACE
}  // namespace osteomill
HWY_AFTER_NAMESPACE();

#endif
