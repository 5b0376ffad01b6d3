#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/execution_context.hpp"
#include "lancet/runtime/schedule/first_exception.hpp"
#include "lancet/runtime/schedule/flush_denormals.hpp"
#include "lancet/runtime/schedule/function_reference.hpp"

namespace lancet::runtime {

/// Throws lancet::Error if a loop is asked for a negative number of blocks.
inline void require_block_count(int blocks) {
    if (blocks < 0) throw Error("for_each_block: " + std::to_string(blocks) + " blocks; expected 0 or more");
}

/// Runs all blocks of a loop of `scheduler` in order on the calling thread.
inline void run_blocks_here(const void* scheduler, int blocks, FunctionReference<void(int)> body) {
    const LoopScope scope(scheduler);
    const FlushDenormals flush;
    for (int block = 0; block < blocks; ++block) body(block);
}

/// A loop cut into contiguous chunks of blocks, as equal as can be, of which each runs on one thread.
class ChunkedLoop {
  public:
    ChunkedLoop(const void* scheduler, int blocks, int chunks, FunctionReference<void(int)> body) noexcept
        : scheduler_(scheduler), blocks_(blocks), chunks_(std::min(blocks, chunks)), body_(body) {}

    int chunks() const noexcept { return chunks_; }

    /// Runs the blocks of one chunk on the calling thread.
    void run_chunk(int chunk) noexcept {
        const LoopScope scope(scheduler_);
        const FlushDenormals flush;
        const int end = first_block(chunk + 1);
        int block = first_block(chunk);
        try {
            for (; block < end && !exception_.precedes(block); ++block) body_(block);
        } catch (...) {
            exception_.record(block);
        }
    }

    /// Call when all chunks have ended: throws what the first block that threw has thrown.
    void rethrow() { exception_.rethrow(); }

  private:
    int first_block(int chunk) const noexcept { return static_cast<int>(std::int64_t{blocks_} * chunk / chunks_); }

    const void* scheduler_;
    int blocks_;
    int chunks_;
    FunctionReference<void(int)> body_;
    FirstException exception_;
};

}  // namespace lancet::runtime
