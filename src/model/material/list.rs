//! What the list of rubbers makes.

/// Makes of a list `module: Law, ..` the modules, and `for_rubbers!`, which gives the laws to another macro.
macro_rules! rubbers {
    ($($module:ident: $Law:ident),+ $(,)?) => {
        $(
            mod $module;
            pub use $module::$Law;
        )+

        /// Gives every law of the list to a macro.
        macro_rules! for_rubbers {
            ($make:ident) => {
                $make! { $($Law),+ }
            };
        }
    };
}
