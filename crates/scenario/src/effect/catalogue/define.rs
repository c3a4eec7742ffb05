//! Makes enums, names and conversions from the list of effects.

/// Defines `EffectKind`, one enum with named values for each family, and `Typed` over the families.
macro_rules! effects {
    ($(
        $(#[$family_doc:meta])*
        $Family:ident: $Effect:ident on $Target:ident $(($bound:ident: $type:ty = $given:expr))? {
            $(
                $Kind:ident $name:literal is $Variant:ident in [$($Model:ident),+]
                $(beyond $Limit:ident)? $(follows $Signal:ident)?: $text:literal {
                    $($value:ident: $meaning:literal = $info:expr),+ $(,)?
                }
            )+
        }
    )+) => {
        /// Every kind of effect.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum EffectKind {
            $($(#[doc = $text] $Kind,)+)+
        }

        impl EffectKind {
            /// All kinds.
            pub const ALL: &'static [EffectKind] = &[$($(EffectKind::$Kind),+),+];

            pub(super) fn entry(self) -> &'static Entry {
                match self {
                    $($(EffectKind::$Kind => {
                        const ENTRY: Entry = Entry {
                            name: $name,
                            family: Family::$Family,
                            target: TargetKind::$Target,
                            description: $text,
                            parameters: &[$(described($info, $meaning)),+],
                            models: &[$(Model::$Model),+],
                            limits: &[$(EffectKind::$Limit)?],
                            follows: [$(Some(Signal::$Signal),)? None][0],
                        };
                        &ENTRY
                    })+)+
                }
            }
        }

        /// Where an effect belongs.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Family {
            $($(#[$family_doc])* $Family,)+
        }

        $(
            $(#[$family_doc])*
            /// Its values are SI, in the coordinate of the joint or the unit of the channel.
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub enum $Effect {
                $(#[doc = $text] $Variant { $(#[doc = $meaning] $value: f64),+ },)+
            }

            impl $Effect {
                fn of(kind: EffectKind, values: &[f64]) -> Option<$Effect> {
                    match kind {
                        $(EffectKind::$Kind => {
                            let &[$($value),+] = values else {
                                return None;
                            };
                            Some($Effect::$Variant { $($value),+ })
                        })+
                        _ => None,
                    }
                }

                /// The values in the order of [`EffectKind::parameters`].
                pub fn values(self) -> Vec<f64> {
                    match self {
                        $($Effect::$Variant { $($value),+ } => vec![$($value),+],)+
                    }
                }
            }
        )+

        /// An effect by family, with what it acts on and its values by name.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Typed<'a> {
            $($(#[$family_doc])* $Family($($type,)? $Effect),)+
        }

        impl Typed<'_> {
            /// The values in the order of [`EffectKind::parameters`].
            pub fn values(&self) -> Vec<f64> {
                match self {
                    $(Typed::$Family(.., effect) => effect.values(),)+
                }
            }
        }

        impl Effect {
            /// The effect by family, with its values by name; `None` if target or number of values
            /// does not fit the kind, which [`Effect::check`] tells.
            pub fn typed(&self) -> Option<Typed<'_>> {
                Some(match self.kind.family() {
                    $(Family::$Family => {
                        let Target::$Target $(($bound))? = &self.target else {
                            return None;
                        };
                        Typed::$Family($($given,)? $Effect::of(self.kind, self.named()?)?)
                    })+
                })
            }
        }
    };
}

pub(super) use effects;
