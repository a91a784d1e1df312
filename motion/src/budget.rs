//! When to give up: a callback that long calculations poll once per outer iteration.

/// Asks whoever waits for the result whether it still matters.
pub struct Budget<'a> {
    should_stop: &'a dyn Fn() -> bool,
}

/// The calculation was stopped by its [`Budget`]; there is no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

impl<'a> Budget<'a> {
    /// A budget that ends when `should_stop` says so.
    #[must_use]
    pub fn until(should_stop: &'a dyn Fn() -> bool) -> Self {
        Self { should_stop }
    }

    /// A budget without end. Every calculation ends by itself; this one is not cut short.
    #[must_use]
    pub fn unlimited() -> Budget<'static> {
        Budget { should_stop: &|| false }
    }

    /// Returns [`Stopped`] once the budget has ended.
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits for the result any more.
    pub fn check(&self) -> Result<(), Stopped> {
        if (self.should_stop)() {
            return Err(Stopped);
        }
        Ok(())
    }
}

impl std::fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Budget").finish_non_exhaustive()
    }
}
