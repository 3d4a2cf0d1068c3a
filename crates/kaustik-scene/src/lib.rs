//! Scenes for light transport: glTF, materials, textures, emitters, cameras, built-in scenes.
