// The page of `camgeo design`.

document.documentElement.dataset.ready = "true";
