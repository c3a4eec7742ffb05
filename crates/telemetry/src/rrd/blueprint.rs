//! Building blocks of a viewer layout.
//!
//! The viewer's library has a builder that cannot set a camera, an axis or a legend, so the
//! layout's store is written here, entity by entity, as that builder would.

use super::store::{Logged, Store};
use re_log_types::ApplicationId;
use re_sdk_types::AsComponents;
use re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint,
};
use re_sdk_types::blueprint::components as kinds;
use re_sdk_types::external::uuid::Uuid;

/// A view or a container, by its path in the layout's store. Paths are random: the viewer keeps
/// what it knows of a view under its path even when another layout takes over.
pub(super) struct Part(String);

/// A layout under construction.
pub(super) struct Layout {
    store: Store,
}

impl Layout {
    pub(super) fn new(application: ApplicationId) -> Logged<Layout> {
        let store = Store::layout(application)?;
        Ok(Layout { store })
    }

    /// A view of a class, with the entities that match the queries, and with properties by name.
    pub(super) fn view(
        &self,
        class: &str,
        title: &str,
        origin: &str,
        queries: &[String],
        properties: &[(&str, &dyn AsComponents)],
    ) -> Logged<Part> {
        let path = format!("view/{}", Uuid::new_v4());
        let contents = ViewContents::new(queries.iter().map(String::as_str));
        self.store.log(format!("{path}/ViewContents"), &contents)?;
        let view = ViewBlueprint::new(class)
            .with_display_name(title)
            .with_space_origin(origin);
        self.store.log(path.as_str(), &view)?;
        for (name, property) in properties {
            self.store.log(format!("{path}/{name}"), *property)?;
        }
        Ok(Part(path))
    }

    /// A text.
    pub(super) fn document(&self, title: &str, entity: &str) -> Logged<Part> {
        self.view("TextDocument", title, entity, &["$origin".to_owned()], &[])
    }

    /// Parts side by side, with shares of the width.
    pub(super) fn side_by_side(&self, parts: Vec<(f32, Part)>) -> Logged<Part> {
        let (shares, parts): (Vec<f32>, Vec<Part>) = parts.into_iter().unzip();
        let container =
            ContainerBlueprint::new(kinds::ContainerKind::Horizontal).with_col_shares(shares);
        self.container(container, &parts)
    }

    /// Parts one above the other, with shares of the height.
    pub(super) fn stacked(&self, parts: Vec<(f32, Part)>) -> Logged<Part> {
        self.stack(
            ContainerBlueprint::new(kinds::ContainerKind::Vertical),
            parts,
        )
    }

    /// As [`Layout::stacked`], with a title for where it is one of several tabs.
    pub(super) fn titled_stack(&self, title: &str, parts: Vec<(f32, Part)>) -> Logged<Part> {
        let container = ContainerBlueprint::new(kinds::ContainerKind::Vertical);
        self.stack(container.with_display_name(title), parts)
    }

    fn stack(&self, container: ContainerBlueprint, parts: Vec<(f32, Part)>) -> Logged<Part> {
        let (shares, parts): (Vec<f32>, Vec<Part>) = parts.into_iter().unzip();
        self.container(container.with_row_shares(shares), &parts)
    }

    /// Parts of which one is seen at a time, the first to begin with.
    pub(super) fn tabs(&self, parts: &[Part]) -> Logged<Part> {
        let mut container = ContainerBlueprint::new(kinds::ContainerKind::Tabs);
        if let Some(Part(first)) = parts.first() {
            container = container.with_active_tab(first.as_str());
        }
        self.container(container, parts)
    }

    /// Parts as tabs; one alone stands without.
    pub(super) fn pages(&self, mut parts: Vec<Part>) -> Logged<Part> {
        if parts.len() == 1 {
            return Ok(parts.remove(0));
        }
        self.tabs(&parts)
    }

    fn container(&self, container: ContainerBlueprint, parts: &[Part]) -> Logged<Part> {
        let path = format!("container/{}", Uuid::new_v4());
        let contents = parts.iter().map(|Part(path)| path.as_str());
        self.store
            .log(path.as_str(), &container.with_contents(contents))?;
        Ok(Part(path))
    }

    /// Ends the layout with this container as its root and makes it the recording's.
    pub(super) fn send(self, Part(root): &Part, play: kinds::PlayState, to: &Store) -> Logged<()> {
        let id = root
            .strip_prefix("container/")
            .and_then(|id| Uuid::parse_str(id).ok());
        let bytes = id.unwrap_or_default().into_bytes();
        let viewport = ViewportBlueprint::new()
            .with_root_container(re_sdk_types::datatypes::Uuid { bytes })
            .with_auto_layout(false)
            .with_auto_views(false);
        self.store.log("viewport", &viewport)?;
        let collapsed = PanelBlueprint::new().with_state(kinds::PanelState::Collapsed);
        self.store.log("blueprint_panel", &collapsed)?;
        self.store.log("selection_panel", &collapsed)?;
        let time = TimePanelBlueprint::new()
            .with_state(kinds::PanelState::Collapsed)
            .with_timeline(super::TIMELINE)
            .with_playback_speed(0.5)
            .with_play_state(play)
            .with_loop_mode(kinds::LoopMode::All);
        self.store.log("time_panel", &time)?;
        to.show(self.store)
    }
}
