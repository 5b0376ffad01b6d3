#pragma once

namespace lancet::kernels {

/// Tags of the instruction sets that kernels are instantiated for. Every function and type that is compiled with the
/// flags of an instruction set carries its tag as a template argument, so that no two objects of a program share a
/// symbol that was compiled for different machines (one-definition rule).
namespace isa {
struct scalar;  ///< one lane, no vector instructions: the reference
struct sse2;    ///< 128 bits
struct avx2;    ///< 256 bits with fused multiply-add
struct avx512;  ///< 512 bits (F, CD, DQ, BW, VL)
struct neon;    ///< 128 bits, AArch64
}  // namespace isa

}  // namespace lancet::kernels
