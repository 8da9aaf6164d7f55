"""Card of import and export: reads files of other programs, and writes the field that is shown."""

import asyncio
from collections.abc import Awaitable, Callable
from html import escape

from nicegui import events, ui

from drawbar.console.access_control import LARGEST_UPLOAD
from drawbar.console.language.words import Words
from drawbar.console.next_drive import NextDrive
from drawbar.console.page_head import tell
from drawbar.console.widgets import button, card
from drawbar.errors import DrawbarError
from drawbar.fields.exchange import KINDS, WRITERS, take_in
from drawbar.fields.field import Field

_CHOOSE = """
<q-btn no-caps unelevated icon="upload_file" label="{text}" :loading="props.isUploading" @click="props.pickFiles" />
<input type="file" class="q-uploader__input" hidden @change="(event) => props.addFiles(event.target.files)">
"""
"""one button with a name; Quasar's own header has none for keyboard and screen reader"""


class ExchangeCard:
    """Takes files, and gives them."""

    def __init__(
        self,
        next_drive: NextDrive,
        words: Words,
        shown: Callable[[], Field | None],
        keep: Callable[[tuple[Field, ...]], Awaitable[None]],
    ) -> None:
        """Build the card; `shown` returns the field to export, `keep` keeps what was imported."""
        self._frame, self._words, self._shown, self._keep = next_drive.frame, words, shown, keep
        with card(words("import_export")):
            upload = ui.upload(
                on_upload=self._take,
                on_rejected=lambda: tell(words("too_large", size=LARGEST_UPLOAD >> 20)),
                auto_upload=True,
                max_file_size=LARGEST_UPLOAD,
            )
            upload.add_slot("header", _CHOOSE.format(text=escape(words("import_file"))))
            ui.label(words("import_kinds", kinds=", ".join(KINDS))).classes("note")
            with ui.element("div").classes("line-up"):
                self._kind = ui.select(list(WRITERS), value="GeoJSON", label=words("format")).props("outlined")
                button(words("export"), self._give)

    async def _take(self, event: events.UploadEventArguments) -> None:
        data = await event.file.read()
        try:
            fields = await asyncio.to_thread(take_in, event.file.name, data, self._frame)
            await self._keep(fields)
        except DrawbarError as error:
            tell(self._words.message(error))
            return
        left_out = [each for field in fields for each in field.left_out]
        lines = sum(len(field.lines) for field in fields)
        tell(self._words("imported", fields=", ".join(field.name for field in fields), lines=lines), good=True)
        if left_out:
            tell(self._words("left_out", what=", ".join(map(self._words.message, left_out))))

    async def _give(self) -> None:
        field = self._shown()
        if field is None:
            tell(self._words("no_field"))
            return
        suffix, write = WRITERS[self._kind.value]
        name = "TASKDATA.XML" if self._kind.value.startswith("ISOXML") else f"{field.name}{suffix}"
        try:
            ui.download.content(await asyncio.to_thread(write, field), name)
        except DrawbarError as error:
            tell(self._words.message(error))
