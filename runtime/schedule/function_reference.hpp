#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

namespace lancet::runtime {

/// Non-owning reference to a callable; two pointers, never allocates. The callable must outlive every call: pass one
/// as a function argument, do not store it.
template <class Signature>
class FunctionReference;

template <class Result, class... Arguments>
class FunctionReference<Result(Arguments...)> {
  public:
    /// Refers to `callable`, which may be a lambda, a function object or a function.
    // NOLINTBEGIN(bugprone-forwarding-reference-overload): what that check fears is excluded by the constraint
    template <class Callable>
    requires(!std::same_as<std::remove_cvref_t<Callable>, FunctionReference> &&
             std::is_invocable_r_v<Result, Callable&, Arguments...>) FunctionReference(Callable&& callable)
    noexcept
        : object_(address_of(callable)), call_([](void* object, Arguments... arguments) -> Result {
              using Pointer = std::add_pointer_t<std::remove_reference_t<Callable>>;
              return std::invoke(*reinterpret_cast<Pointer>(object), std::forward<Arguments>(arguments)...);
          }) {}
    // NOLINTEND(bugprone-forwarding-reference-overload)

    Result operator()(Arguments... arguments) const { return call_(object_, std::forward<Arguments>(arguments)...); }

  private:
    template <class Callable>
    static void* address_of(Callable& callable) noexcept {
        if constexpr (std::is_function_v<Callable>) {
            return reinterpret_cast<void*>(&callable);
        } else {
            return const_cast<void*>(static_cast<const volatile void*>(std::addressof(callable)));
        }
    }

    void* object_;
    Result (*call_)(void*, Arguments...);
};

}  // namespace lancet::runtime
